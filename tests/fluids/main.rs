//! Equations of state in runs: shocks against their jump conditions, pores, explosives, tables,
//! materials of the library, and every bad constant with its message.

mod bits;
mod burn;
mod library;
mod options;
mod pistons;
mod refused;
mod tools;
