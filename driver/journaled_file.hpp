// HDF5 files that change from flush to flush as a whole, whatever kills the program in between.
//
// A flush of HDF5 is many writes, and a file between two of them may be none. Here what a flush
// changes of the file as the flush before left it goes to a journal first, .NAME.journal beside the
// file, and then to its place. Who opens the file through this module sees the journal applied.
#pragma once

#include "hdf5.hpp"

#include <string>

namespace ricochet::driver {

/// Makes files that are opened with these properties journaled ones.
void set_journaled(hdf5::Properties const& access);

/// Removes the journal of the file at `path`: it is of no use, because the file is replaced.
void forget_journal(std::string const& path);

/// Removes the journal unless the file needs it; for a file that was left open after an error.
void tidy_journal(std::string const& path);

} // namespace ricochet::driver
