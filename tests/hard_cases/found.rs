//! What the search has found, kept as it was found.
