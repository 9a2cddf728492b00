#include "pictures/movie.hpp"

#include <fmt/format.h>

#include <filesystem>

namespace ricochet::driver {

namespace {

std::vector<std::string> command(std::string const& path, std::string const& place, int width,
                                 int height, double rate)
{
  std::vector<std::string> words{"ffmpeg",
                                 "-v",
                                 "error",
                                 "-f",
                                 "rawvideo",
                                 "-pix_fmt",
                                 "rgb24",
                                 "-s",
                                 fmt::format("{}x{}", width, height),
                                 "-r",
                                 fmt::format("{}", rate),
                                 "-i",
                                 "-"};
  for (std::string const& word : encoding(path))
    words.push_back(word);
  words.insert(words.end(), {"-y", "file:" + place});
  return words;
}

} // namespace

bool is_movie(std::string const& path)
{
  auto const kind = std::filesystem::path(path).extension();
  return kind == ".mp4" || kind == ".gif";
}

std::vector<std::string> encoding(std::string const& path)
{
  if (std::filesystem::path(path).extension() == ".gif")
    return {"-filter_complex", "split[a][b];[a]palettegen[p];[b][p]paletteuse", "-f", "gif"};
  // Players want yuv420p, which takes an even number of pixels each way.
  return {"-c:v",      "libx264",    "-pix_fmt", "yuv420p", "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2",
          "-movflags", "+faststart", "-f",       "mp4"};
}

Movie::Movie(std::string const& path, int width, int height, double rate, bool replace)
  : file_(path, replace), ffmpeg_(command(path, file_.place(), width, height, rate))
{
}

void Movie::add(Picture const& picture)
{
  ffmpeg_.write(picture.bytes().data(), picture.bytes().size());
}

void Movie::finish()
{
  ffmpeg_.finish();
  file_.commit();
}

} // namespace ricochet::driver
