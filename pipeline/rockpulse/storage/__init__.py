"""Storage of results: declared variables, HDF5 files written as a whole or not at all, exported tables, checksums."""
