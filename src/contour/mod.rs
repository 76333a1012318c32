//! contour (being written)
