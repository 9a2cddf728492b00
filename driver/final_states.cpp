#include "final_states.hpp"

#include "text.hpp"

#include <string>

namespace ricochet::driver {

void write_states(OutputFile& file, std::vector<DiscState> const& discs)
{
  constexpr std::size_t full = 1 << 16;
  std::string text;
  text.reserve(full + 128);
  for (DiscState const& disc : discs) {
    append_shortest(text, disc.x);
    text += ',';
    append_shortest(text, disc.y);
    text += ',';
    append_shortest(text, disc.vx);
    text += ',';
    append_shortest(text, disc.vy);
    text += '\n';
    if (text.size() >= full) {
      file.write(text);
      text.clear();
    }
  }
  file.write(text);
}

} // namespace ricochet::driver
