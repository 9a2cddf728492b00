// Movies, which ffmpeg encodes.
#pragma once

#include "child_process.hpp"
#include "output_file.hpp"
#include "pictures/picture.hpp"

#include <memory>
#include <string>
#include <vector>

namespace ricochet::driver {

/// True if this is the name of a movie: OUT.mp4 or OUT.gif.
bool is_movie(std::string const& path);

/// What follows `ffmpeg` and its input to make a movie as `path` is called.
std::vector<std::string> encoding(std::string const& path);

/// A movie on its way to a file.
class Movie {
 public:
  /// Throws Failure if the file cannot be made or ffmpeg not be started.
  Movie(std::string const& path, int width, int height, double rate, bool replace);

  /// Appends a picture of the size given. Throws Failure.
  void add(Picture const& picture);

  /// Puts the movie in its place. Throws Failure.
  void finish();

 private:
  OutputFile file_;
  ChildProcess ffmpeg_;
};

} // namespace ricochet::driver
