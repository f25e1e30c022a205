//! Values that the performance model predicts for a configuration.

use super::configuration::Configuration;
use crate::perf_model::{Machine, Work, predict_run};
use crate::scene::CheckedScene;

/// Predictions for a configuration.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RowPrediction {
    /// Time of a step \[s\]; `None` without the constants of a machine.
    pub step: Option<f64>,
    /// Bytes sent per step, all ranks, without outputs \[B\].
    pub bytes: f64,
    /// Number of messages sent per step, all ranks, without outputs \[-\].
    pub messages: f64,
}

impl RowPrediction {
    /// Predictions for `scene`. Bytes and messages are counted, the time follows from `machine`.
    pub fn new(scene: &CheckedScene, on: Configuration, machine: Option<&Machine>) -> Self {
        let Configuration { ranks, threads } = on;
        let (work, share) = (Work::new(scene), Work::share(scene, ranks, threads, None, 0.0));
        let sent = work.sent(&share);
        // of very many ranks, some stand for all
        let of_all = share.layout.working as f64 / sent.len().max(1) as f64;
        let of_scene = (scene, &work);
        RowPrediction {
            step: machine
                .map(|m| predict_run(m, &m.network, of_scene, [ranks, threads], None).step),
            bytes: of_all * sent.iter().map(|sent| sent.bytes).sum::<f64>(),
            messages: of_all * sent.iter().map(|sent| sent.messages).sum::<f64>(),
        }
    }
}
