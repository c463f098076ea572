"""Results files in netCDF-4/HDF5: writing (as a whole or not at all), reading and verification."""
