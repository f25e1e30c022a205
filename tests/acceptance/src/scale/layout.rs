//! A million patches on 125 000 ranks: memory of the layout and the plans of one rank, and time of a
//! new assignment.

use std::time::Instant;

use decomp::{
    GhostExchange, GhostReach, IndexBox, Layout, NodeExchange, PatchLoads, SideKind,
    assign_with_short_borders,
};

use crate::bounds::{Unit, scale as bounds};
use crate::heap;
use crate::table::Table;

/// Patches per direction of a square.
const PATCHES: usize = 1000;

/// Ranks: eight patches for each.
const RANKS: usize = 125_000;

/// Cells of a patch per direction.
const CELLS: usize = 16;

/// Repetitions of a measured time.
const REPETITIONS: usize = 7;

/// Share of the patches that are active in the new assignment.
const ACTIVE: f64 = 0.5;

/// Bytes that a rank in the middle holds at the start and after a new assignment, and its time.
pub fn check(table: &mut Table) {
    let particles = |patch: usize| 64 + (patch * 7919 % 97) as u64;
    let weights: Vec<u64> = (0..PATCHES * PATCHES).map(particles).collect();
    let cells = IndexBox::new([0; 2], [(PATCHES * CELLS) as i64; 2]);
    let before = heap::held();
    let layout = Layout::new(cells, [[SideKind::Mirror, SideKind::Open]; 2], [PATCHES; 2]);
    let layout = assign_with_short_borders(layout, &weights, RANKS);
    let name = "1e6 patches on 125 000 ranks";
    let held = held_by(&layout, before);
    let figure = format!("{name}: layout and plans of a rank");
    table.check(&figure, Some(held), bounds::layout::HELD);

    let order = layout.order().patches();
    let is_active = |patch: usize| {
        let from_middle = |k: usize| k as f64 / PATCHES as f64 - 0.5;
        let away = from_middle(patch % PATCHES).hypot(from_middle(patch / PATCHES));
        away * away * std::f64::consts::PI < ACTIVE
    };
    // nanoseconds that differ from patch to patch
    let cost = |patch: usize| 900 * particles(patch) + (patch * 104_729 % 5003) as u64;
    let work: Vec<u64> =
        order.iter().map(|&patch| if is_active(patch) { cost(patch) } else { 0 }).collect();
    let particles: Vec<u64> = order.iter().map(|&patch| weights[patch]).collect();
    let loads = PatchLoads { work: &work, particles: &particles };
    let owners = layout.ranks();
    let mut least = f64::INFINITY;
    for _ in 0..REPETITIONS {
        let start = Instant::now();
        let _ = std::hint::black_box(loads.reassign(&owners, RANKS, 1.25));
        least = least.min(start.elapsed().as_secs_f64());
    }
    let figure = format!("{name}: new assignment");
    table.check(&figure, Some(least), bounds::layout::NEW_ASSIGNMENT);
    let wanted = loads.reassign(&owners, RANKS, 1.25);
    drop((order, work, particles, owners, weights));
    let before = heap::held();
    let layout = layout.clone().with_ranks(layout.order(), &wanted);
    let figure = "  layout and plans of a rank after it";
    table.beside(figure, Some(held_by(&layout, before)), "", Unit::Bytes);
}

/// Bytes of `layout`, made since the heap held `before`, and of the plans of a rank.
fn held_by(layout: &Layout<2>, before: f64) -> f64 {
    let reach = GhostReach { depth: 3, travel: 1, notice: Some(5) };
    let particles = GhostExchange::new(layout, RANKS / 2, reach);
    let nodes = NodeExchange::layered(layout, RANKS / 2, 4, 6, 1);
    let held = heap::held() - before;
    drop((particles, nodes));
    held
}
