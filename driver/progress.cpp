#include "progress.hpp"

#include "log.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <sys/ioctl.h>
#include <unistd.h>

namespace ricochet::driver {

namespace {

using namespace std::chrono_literals;

constexpr auto bar_interval = 100ms;
constexpr auto line_interval = 30s;
constexpr double line_share = 0.05; // of the run, at least, from line to line

int terminal_width()
{
  winsize size{};
  return ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

} // namespace

Progress::Style Progress::style_for(bool quiet)
{
  if (quiet)
    return Style::none;
  char const* const term = std::getenv("TERM");
  bool const can_draw =
      log_format() == LogFormat::text && term && std::string(term) != "dumb" && !std::getenv("CI");
  return can_draw && ::isatty(STDERR_FILENO) ? Style::bar : Style::lines;
}

Progress::Progress(Style style, std::int64_t discs, std::int64_t steps, std::int64_t first)
  : style_(style),
    discs_(discs),
    steps_(steps),
    first_(first),
    begin_(Clock::now()),
    next_(begin_ + (style == Style::bar ? Clock::duration(2 * bar_interval)
                                        : Clock::duration(line_interval))),
    logged_step_(first)
{
}

Progress::~Progress()
{
  clear();
}

bool Progress::is_due() const
{
  return style_ != Style::none && Clock::now() >= next_;
}

void Progress::update(std::int64_t step, double energy)
{
  std::chrono::duration<double> const spent = Clock::now() - begin_;
  double const per_second = static_cast<double>(step - first_) / std::max(spent.count(), 1e-9);
  double const rate = per_second * static_cast<double>(discs_);
  double const left = static_cast<double>(steps_ - step) / std::max(per_second, 1e-9);
  if (style_ == Style::bar) {
    draw(step, rate, left);
    next_ = Clock::now() + bar_interval;
  } else if (style_ == Style::lines) {
    bool const far_enough =
        static_cast<double>(step - logged_step_) >= line_share * static_cast<double>(steps_);
    if (far_enough) {
      log(step, rate, left, energy);
      logged_step_ = step;
      next_ = Clock::now() + line_interval;
    }
  }
}

void Progress::draw(std::int64_t step, double rate, double left)
{
  double const share =
      static_cast<double>(step) / static_cast<double>(std::max<std::int64_t>(1, steps_));
  std::string const numbers = fmt::format(" {:3.0f} %  step {}/{}  {:.2e} disc steps/s  {} left",
                                          100 * share, step, steps_, rate, clock_text(left));
  int const width = std::clamp(terminal_width() - static_cast<int>(numbers.size()) - 3, 0, 40);
  int const full = static_cast<int>(std::floor(share * width));
  std::string const bar = width < 5
                              ? ""
                              : "[" + std::string(static_cast<std::size_t>(full), '#') +
                                    std::string(static_cast<std::size_t>(width - full), '.') + "]";
  std::string const line =
      (bar + numbers).substr(0, static_cast<std::size_t>(std::max(1, terminal_width() - 1)));
  std::fprintf(stderr, "\r%s\033[K", line.c_str());
  std::fflush(stderr);
  is_drawn_ = true;
}

void Progress::log(std::int64_t step, double rate, double left, double energy)
{
  double const percent =
      100 * static_cast<double>(step) / static_cast<double>(std::max<std::int64_t>(1, steps_));
  log_event("progress", {{"step", step},
                         {"steps", steps_},
                         {"pct", percent},
                         {"rate", rate},
                         {"eta", clock_text(left)},
                         {"E", energy}});
}

void Progress::clear()
{
  if (!is_drawn_)
    return;
  std::fputs("\r\033[K", stderr);
  std::fflush(stderr);
  is_drawn_ = false;
}

std::string clock_text(double seconds)
{
  constexpr double longest = 1e9;
  auto const whole = std::llround(std::clamp(seconds, 0.0, longest));
  return fmt::format("{:02}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

std::string utc_now()
{
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
}

} // namespace ricochet::driver
