//! Several ranks, as threads of this process: they see what one rank sees, their messages come
//! as promised, and one that fails or hangs leaves no other waiting.

mod layouts;
mod messages;
mod stalls;
