#include "pictures/render.hpp"

#include "child_process.hpp"
#include "output_file.hpp"
#include "pictures/frame_painter.hpp"
#include "pictures/frame_source.hpp"
#include "pictures/movie.hpp"
#include "pictures/page.hpp"
#include "pictures/viewer.hpp"
#include "pictures/window.hpp"
#include "text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <optional>

namespace ricochet::driver {

namespace {

using Clock = std::chrono::steady_clock;

// Paints the chosen frames one after the other and hands each to `use`.
class Show {
 public:
  Show(RenderOptions const& options, FrameSource& source, std::vector<std::int64_t> const& frames)
    : source_(source), frames_(frames), painter_(source.stage(), options.look)
  {
  }

  Layout const& layout() const { return painter_.layout(); }
  std::int64_t frames() const { return static_cast<std::int64_t>(frames_.size()); }

  template <class Use>
  void run(Use const& use)
  {
    std::vector<DiscState> discs;
    for (std::int64_t const frame : frames_) {
      source_.read(frame, discs);
      auto const start = Clock::now();
      std::clock_t const processor_start = std::clock();
      Picture const& picture = painter_.paint(source_.time(frame), discs);
      painting_ += Clock::now() - start;
      processor_ += std::clock() - processor_start;
      use(picture);
    }
  }

  /// "3 frames of 640x480 (12.3 ms to paint one, 20.1 ms of processors)"
  std::string in_words() const
  {
    auto const each = 1 / static_cast<double>(frames());
    return fmt::format("{} frame{} of {}x{} ({:.1f} ms to paint one, {:.1f} ms of processors)",
                       frames(), frames() == 1 ? "" : "s", layout().width, layout().height,
                       painting_.count() * each,
                       1e3 * static_cast<double>(processor_) / CLOCKS_PER_SEC * each);
  }

 private:
  FrameSource& source_;
  std::vector<std::int64_t> const& frames_;
  FramePainter painter_;
  std::chrono::duration<double, std::milli> painting_{};
  std::clock_t processor_ = 0; ///< time of all threads
};

void write_png(std::string const& path, Picture const& picture, bool replace)
{
  OutputFile file(path, replace);
  file.write(as_png(picture));
  file.commit();
}

std::string write_series(std::string const& path, bool replace, Show& show)
{
  for (std::int64_t number = 0; number < show.frames(); ++number)
    check_output(series_name(path, number), replace);
  std::int64_t number = 0;
  show.run(
      [&](Picture const& picture) { write_png(series_name(path, number++), picture, replace); });
  return fmt::format("{} ... {}", series_name(path, 0), series_name(path, number - 1));
}

// Without ffmpeg: the pictures, and how they become a movie.
[[noreturn]] void write_pictures_of_movie(RenderOptions const& options, Show& show)
{
  auto const pictures = std::filesystem::path(options.output).replace_extension(".png").string();
  std::string const series = write_series(pictures, options.force, show);
  std::string pattern = series_name(pictures, 0);
  pattern.replace(pattern.size() - 10, 6, "%06d");
  std::vector<std::string> words{"ffmpeg", "-r", fmt::format("{}", options.fps), "-i", pattern};
  for (std::string const& word : encoding(options.output))
    words.push_back(word);
  words.push_back(options.output);
  std::string command;
  for (std::string const& word : words)
    command += (command.empty() ? "" : " ") + for_shell(word);
  throw Failure(Exit::failed,
                fmt::format("there is no ffmpeg to make '{}' (install the package ffmpeg); its "
                            "pictures are {}, and this makes a movie of them:\n{}",
                            options.output, series, command));
}

// Writes the pictures or the movie and tells what there is.
std::string write_output(RenderOptions const& options, Show& show)
{
  std::string name = options.output;
  if (is_movie(name)) {
    if (!is_installed("ffmpeg"))
      write_pictures_of_movie(options, show);
    Movie movie(name, show.layout().width, show.layout().height, options.fps, options.force);
    show.run([&](Picture const& picture) { movie.add(picture); });
    movie.finish();
  } else if (options.frame) {
    show.run([&](Picture const& picture) { write_png(name, picture, options.force); });
  } else {
    name = write_series(name, options.force, show);
  }
  return name + ": " + show.in_words();
}

std::string write_page(RenderOptions const& options, FrameSource& source,
                       std::vector<std::int64_t> const& frames)
{
  Page page(options.html, source.stage(), options.look, options.fps, options.force);
  std::vector<DiscState> discs;
  for (std::int64_t const frame : frames) {
    source.read(frame, discs);
    page.add(source.time(frame), discs);
  }
  page.finish();
  std::error_code ignored;
  auto const bytes = std::filesystem::file_size(options.html, ignored);
  return fmt::format("{}: {} frame{}, {:.1f} MB", options.html, frames.size(),
                     frames.size() == 1 ? "" : "s", static_cast<double>(bytes) / 1e6);
}

} // namespace

std::vector<std::int64_t> chosen_frames(RenderOptions const& options, FrameSource const& source)
{
  std::int64_t const count = source.frames();
  if (options.frame) {
    std::int64_t const frame = *options.frame < 0 ? count + *options.frame : *options.frame;
    if (frame < 0 || frame >= count)
      throw Failure(Exit::usage, fmt::format("--frame: found {} (allowed: {}...{}, the last is -1)",
                                             *options.frame, -count, count - 1));
    return {frame};
  }
  std::vector<std::int64_t> chosen;
  if (!options.rate) {
    for (std::int64_t frame = 0; frame < count; frame += options.every)
      chosen.push_back(frame);
    return chosen;
  }
  // Moments at equal distances; each shows the latest frame that is not after it.
  double const first = source.time(0), last = source.time(count - 1);
  double const step = *options.rate / options.fps;
  constexpr double most = 1e6;
  if (!((last - first) / step < most))
    throw Failure(Exit::usage,
                  fmt::format("--rate: found {}, which makes more than {:g} frames (the frames "
                              "span a time of {})",
                              shortest(*options.rate), most, shortest(last - first)));
  std::int64_t frame = 0;
  for (std::int64_t k = 0;; ++k) {
    double const moment = first + static_cast<double>(k) * step;
    double const rounding = 1e-9 * step;
    if (moment > last + rounding)
      return chosen;
    while (frame + 1 < count && source.time(frame + 1) <= moment + rounding)
      ++frame;
    chosen.push_back(frame);
  }
}

std::string series_name(std::string const& path, std::int64_t number)
{
  std::filesystem::path name(path);
  return name.replace_filename(fmt::format("{}_{:06}.png", name.stem().string(), number)).string();
}

Exit render(RenderOptions const& options)
{
  bool const is_series = !options.output.empty() && !options.frame && !is_movie(options.output);
  check_outputs({is_series ? series_name(options.output, 0) : options.output, options.html},
                {options.scene.file, options.scene.config}, options.force);
  KokkosSession const kokkos(options.kokkos);
  auto const source =
      open_frames(options.scene, options.frame == 0 ? Purpose::states : Purpose::run);
  auto const frames = chosen_frames(options, *source);
  auto const tell = [&](std::string const& what) {
    if (!options.kokkos.quiet)
      std::fprintf(stderr, "%s\n", what.c_str());
  };
  if (!options.html.empty())
    tell(write_page(options, *source, frames));
  if (!options.output.empty()) {
    Show show(options, *source, frames);
    tell(write_output(options, show));
  }
  if (options.window) {
    Layout const layout = arrange(options.look, source->stage());
    auto const window = open_window(options.scene.file, layout.width, layout.height);
    play(*source, frames, options.look, options.fps, *window);
  }
  return Exit::done;
}

} // namespace ricochet::driver
