//! Several ranks as threads of this process: results equal those of one rank, messages arrive as
//! documented, and a rank that fails or hangs leaves no other rank waiting.

mod layouts;
mod messages;
mod stalls;
