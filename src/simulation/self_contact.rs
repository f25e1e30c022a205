//! First contact of a body with itself; see [`SelfContactEvent`].

use super::run::Simulation;
use crate::simulation::monitor::SelfContactEvent;
use crate::solver::SelfContact;

impl<const D: usize> Simulation<'_, D> {
    /// Whether a step that the monitor checks looks for bodies that touch themselves.
    fn searches_self_contact(&self) -> bool {
        self.stepper.columns.faces.is_some() && self.self_contact.is_none()
    }

    /// Prepares the patches for the next step, after which the monitor checks the state if `checked`.
    pub(super) fn set_self_contact_search(&mut self, checked: bool) {
        let seeks = checked && self.searches_self_contact();
        self.patches.iter_mut().for_each(|p| p.contact.searches_self_contact = seeks);
    }

    /// Stores the narrowest gap that the last step has found, if it is the first of the run.
    /// Collective.
    pub(super) fn note_self_contact(&mut self) {
        if !self.searches_self_contact() {
            return;
        }
        let found = self.patches.iter().filter_map(|p| p.contact.self_contact);
        let mine = found.min_by(|a, b| a.compare(b));
        // gap, then ids, decide among equals of a mirrored scene
        let key = |found: &SelfContact<D>| [found.gap, found.ids[0] as f64, found.ids[1] as f64];
        let mut candidate = mine;
        let mut least = [f64::INFINITY; 3];
        for (k, least) in least.iter_mut().enumerate() {
            let value = candidate.map_or(f64::INFINITY, |found| key(&found)[k]);
            let mut all = [value];
            self.comm.min(&mut all);
            *least = all[0];
            if *least == f64::INFINITY {
                return;
            }
            candidate = candidate.filter(|_| value == *least);
        }
        let travel = self.frame.travel(self.time);
        let place = |a: usize| candidate.map(|found| found.place[a] + travel[a]);
        let coordinate = |a: usize| if a < D { place(a) } else { candidate.map(|_| 0.0) };
        let body = candidate.map(|found| found.body as f64);
        let mut values =
            [body, coordinate(0), coordinate(1)].map(|value| value.unwrap_or(f64::INFINITY));
        self.comm.min(&mut values);
        let [body, x, y] = values;
        self.self_contact = Some(SelfContactEvent {
            time: self.time,
            body: body as usize,
            place: [x, y],
            gap: least[0],
        });
    }

    /// First contact of a body with itself so far; the same on all ranks.
    pub fn self_contact(&self) -> Option<&SelfContactEvent> {
        self.self_contact.as_ref()
    }
}
