//! The command line and the files as a contract, checked from outside: the built program is
//! started in temporary folders, plain and by mpirun, each time under a limit.

mod accuracy;
mod architecture;
mod bad_files;
mod bad_input;
mod command_line;
mod commands;
mod estimates;
mod every_scene;
mod forecasts;
mod home;
mod outputs;
mod ownership;
mod pictures;
mod program;
mod replacing;
mod scenes;
mod steps;
mod watch;

#[cfg(feature = "mpi")]
mod ranks;
#[cfg(feature = "mpi")]
mod stalls;
