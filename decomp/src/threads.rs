//! Work on the patches of a rank, on one or more threads.

use rayon::ThreadPool;
use rayon::prelude::*;

/// Calls `work` once for each index, with the elements of both slices and with buffers that no other
/// call uses at the same time: `buffers` themselves without `pool`, otherwise new ones.
pub(crate) fn for_each_pair<A: Send, B: Send, Buffers: Default>(
    pool: Option<&ThreadPool>,
    first: &mut [A],
    second: &mut [B],
    buffers: &mut Buffers,
    work: impl Fn(&mut Buffers, usize, &mut A, &mut B) + Sync,
) {
    match pool {
        Some(pool) => {
            let pairs = first.par_iter_mut().zip(second).enumerate();
            let with = |buffers: &mut Buffers, (k, (a, b)): (usize, (&mut A, &mut B))| {
                work(buffers, k, a, b);
            };
            pool.install(|| pairs.for_each_init(Buffers::default, with));
        }
        None => {
            let pairs = first.iter_mut().zip(second).enumerate();
            pairs.for_each(|(k, (a, b))| work(buffers, k, a, b));
        }
    }
}
