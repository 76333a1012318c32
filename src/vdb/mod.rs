//! vdb (being written)
