"""Results as files: the variables with their meaning, HDF5 written whole or not at all, tables, checksums."""
