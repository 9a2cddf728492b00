#include "validate.hpp"

#include "outlook.hpp"
#include "output_file.hpp"

#include <fmt/format.h>

namespace ricochet::driver {

Exit validate(ValidateOptions const& options)
{
  Scene const scene = read_scene(options.scene);
  auto const warnings = doubts(scene, outlook(scene));
  std::string text;
  for (std::string const& warning : warnings)
    text += warning + "\n";
  for (std::string const& note : scene.notes)
    text += note + "\n";
  text += fmt::format("{}: valid: {} discs, {} steps, {} warning{}\n", options.scene.file,
                      scene.discs.size(), scene.steps, warnings.size(),
                      warnings.size() == 1 ? "" : "s");
  OutputFile out("-", false);
  out.write(text);
  out.commit();
  return Exit::done;
}

} // namespace ricochet::driver
