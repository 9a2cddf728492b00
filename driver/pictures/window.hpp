// A window on the screen and what the user does in it.
#pragma once

#include "pictures/picture.hpp"

#include <memory>
#include <string>
#include <vector>

namespace ricochet::driver {

/// Something the user did.
struct Input {
  enum class Kind {
    quit,
    play,    ///< or pause
    forward, ///< one frame; back: likewise
    back,
    first, ///< frame; last: likewise
    last,
    ahead, ///< a tenth of all frames; behind: likewise
    behind,
    faster,
    slower,
    colours, ///< the next way to colour discs
    whole,   ///< the whole box
    zoom,    ///< by `factor`, around the pixel (x, y)
    move     ///< by x, y pixels
  };
  Kind kind;
  double x = 0, y = 0, factor = 1;
};

class Window {
 public:
  virtual ~Window() = default;

  /// Shows a picture of the size of the window.
  virtual void show(Picture const& picture) = 0;

  /// What the user did since the last call; waits for it, but not longer than `seconds`.
  virtual std::vector<Input> inputs(double seconds) = 0;
};

/// False if the program was built without SDL2.
bool has_window();

/// Throws Failure(Exit::failed) if there is no screen or the program was built without SDL2.
std::unique_ptr<Window> open_window(std::string const& title, int width, int height);

} // namespace ricochet::driver
