// Whether this processor can run this program.
#pragma once

namespace ricochet::driver {

/// The name of an instruction set that the program was compiled for and this processor lacks, such
/// as "AVX2"; nullptr if it lacks none.
///
/// On Linux with glibc the program asks by itself before anything else of it runs, initialisers
/// of static objects included, says what lacks on stderr and leaves with exit code 70. Where that
/// does not exist, main() is to call this first.
char const* missing_cpu_feature();

} // namespace ricochet::driver
