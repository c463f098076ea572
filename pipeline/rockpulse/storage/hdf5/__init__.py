"""Results files: netCDF-4 in HDF5, written whole or not at all, read back, checked."""
