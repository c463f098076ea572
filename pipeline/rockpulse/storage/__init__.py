"""Storage of results: declared variables, HDF5 files that are written atomically, exported tables and checksums."""
