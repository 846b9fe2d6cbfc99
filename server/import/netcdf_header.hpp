#pragma once

#include <filesystem>

namespace trochoid {

/// Refuses a classic netCDF file (CDF-1, CDF-2, CDF-5) whose header cannot be true: counts, names, types or dimensions outside what
/// the format allows, or a variable whose values would lie outside the file. The library trusts all that and dies of some of
/// it (4.9.0), and reads zeros, sea level, where a file has been cut short. Files of other kinds (netCDF-4) pass unseen.
/// Throws OperatorError. Source: the netCDF classic format specification (its grammar, in the User's Guide's appendix).
void check_netcdf_header(const std::filesystem::path& path);

}  // namespace trochoid
