"""Results files in netCDF-4/HDF5: atomic writing, reading and verification."""
