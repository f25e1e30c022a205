//! flyer-mpm: impact and shock waves by the material point method.
//!
//! The modules of the library, from the top down; each uses those below it:
//!
//! - [`study`]: parameter studies, each run in its own process; error against time;
//! - [`driver`]: a run with its files;
//! - [`accuracy`]: comparison with exact solutions, error estimates, plans;
//! - [`perf_model`]: prediction of run time and scaling;
//! - [`simulation`]: a run in memory, which joins physics and messages;
//! - [`input`]: reading and checking of a scene;
//! - [`effects`]: optional effects of a scene;
//! - [`solver`]: particles, nodal fields and the time step;
//! - [`scene`]: the data of a scene;
//! - [`geometry`]: bodies and how they are filled with particles;
//! - [`side`]: kinds of side of the domain;
//! - [`balance`]: measures of a patch's load;
//! - [`contact`]: contact laws between bodies;
//! - [`exact`]: closed solutions; depends on materials only;
//! - [`shape`]: shape functions: weights of particles on nodes;
//! - [`transfer`]: transfers of velocity from nodes to particles;
//! - [`material`]: equations of state, strength and failure;
//!
//! Beside them stand two crates: `decomp`, patches and messages, and [`plot`], pictures. They do not
//! depend on this library.
//!
//! # Example
//!
//! The greatest pressure of an impact, without files:
//!
//! ```
//! use decomp::Serial;
//! use flyer_mpm::{input, simulation::Simulation};
//!
//! let text = r#"{
//!     "title": "Copper on copper, 500 m/s",
//!     "domain": {"lower": ["-0.3 mm"], "upper": ["0.3 mm"], "cell_size": "5 um"},
//!     "time": {"end": "20 ns"},
//!     "materials": {"copper": {"library": "copper"}},
//!     "bodies": [
//!         {"name": "flyer", "material": "copper", "velocity": ["500 m/s"],
//!             "box": {"lower": ["-0.2 mm"], "upper": [0.0]}, "particles_per_cell": [2]},
//!         {"name": "target", "material": "copper",
//!             "box": {"lower": [0.0], "upper": ["0.2 mm"]}, "particles_per_cell": [2]}
//!     ]
//! }"#;
//! let scene = input::parse(text.as_bytes(), "scene.json", &[])?;
//! let mut simulation = Simulation::<1>::new(&scene, &Serial, 1)?;
//! let end = scene.scene.time.end;
//! while simulation.time() < end {
//!     simulation.advance(end)?;
//! }
//! let (table, _) = simulation.gather().expect("a rank that runs alone is rank 0");
//! let pressure = table.columns.iter().find(|column| column.name == "pressure").unwrap();
//! let greatest = pressure.values.iter().copied().fold(0.0, f64::max);
//! assert!((9.5e9..10e9).contains(&greatest), "{greatest}");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod accuracy;
pub mod balance;
pub mod contact;
pub mod driver;
pub mod effects;
pub mod exact;
pub mod geometry;
pub mod input;
pub mod material;
pub mod perf_model;
pub mod scene;
pub mod shape;
pub mod side;
pub mod simulation;
pub mod solver;
pub mod study;
pub mod transfer;

pub use plot;
