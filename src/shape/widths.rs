//! Stencil widths: the numbers of nodes along one direction for which kernels are compiled.

/// Greatest width on a line [nodes].
pub const MOST_NODES: usize = 18;

/// Greatest width in a plane [nodes].
pub const MOST_NODES_IN_PLANE: usize = 10;

/// Greatest number of nodes along one direction in the support of a particle.
pub const fn most_nodes(dimension: usize) -> usize {
    if dimension == 1 { MOST_NODES } else { MOST_NODES_IN_PLANE }
}

/// Compiled width for a stencil of `nodes` nodes.
pub const fn padded_width(nodes: usize) -> usize {
    match nodes {
        0..=4 => nodes,
        5..=6 => 6,
        7..=10 => 10,
        _ => MOST_NODES,
    }
}

/// Calls `$call` with the width of a patch's stencils as a constant, and the dimension.
macro_rules! with_width {
    ($width:expr, $call:ident ( $($arg:expr),* )) => {
        match $width {
            0..=2 => $call::<2, D>($($arg),*),
            3 => $call::<3, D>($($arg),*),
            4 => $call::<4, D>($($arg),*),
            6 => $call::<6, D>($($arg),*),
            _ if D > 1 || $width <= 10 => $call::<10, D>($($arg),*),
            _ => $call::<{ $crate::shape::MOST_NODES }, D>($($arg),*),
        }
    };
}
pub(crate) use with_width;

/// Calls `$call` with a shape function, a constant width and the dimension. The width is as given,
/// or for shape functions that depend on the length of the particle the padded width of `$nodes`.
macro_rules! with_shape_width {
    ([$width:literal], $shape:ty, $nodes:expr, $call:ident ( $($arg:expr),* )) => {
        $call::<$shape, $width, D>($($arg),*)
    };
    ([by_length], $shape:ty, $nodes:expr, $call:ident ( $($arg:expr),* )) => {
        match $nodes {
            0..=3 => $call::<$shape, 3, D>($($arg),*),
            4 => $call::<$shape, 4, D>($($arg),*),
            5..=6 => $call::<$shape, 6, D>($($arg),*),
            _ if D > 1 || $nodes <= 10 => $call::<$shape, 10, D>($($arg),*),
            _ => $call::<$shape, { $crate::shape::MOST_NODES }, D>($($arg),*),
        }
    };
}
pub(crate) use with_shape_width;
