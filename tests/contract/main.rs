//! External tests of the command line and the files: the built program is started in temporary
//! folders, directly and by mpirun, each time with a time limit.

mod accuracy;
mod architecture;
mod bad_files;
mod bad_input;
mod command_line;
mod commands;
mod default_method;
mod estimates;
mod every_scene;
mod forecasts;
mod formats;
mod home;
mod imports;
mod materials;
mod monitor;
mod outputs;
mod ownership;
mod pages;
mod pictures;
mod program;
mod replacing;
mod scenes;
mod steps;
mod study_means;
mod templates;
mod terminal;

#[cfg(feature = "mpi")]
mod ranks;
#[cfg(feature = "mpi")]
mod scaling;
#[cfg(feature = "mpi")]
mod stalls;
