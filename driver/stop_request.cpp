#include "stop_request.hpp"

#include "exit_codes.hpp"
#include "text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <unistd.h>
#include <utility>

namespace ricochet::driver {

namespace {

using Clock = std::chrono::steady_clock;

Clock::time_point const program_start = Clock::now();

constexpr int stop_signals[] = {SIGINT, SIGTERM, SIGUSR1};

volatile std::sig_atomic_t asked_to_stop = 0; // the first signal that did
volatile std::sig_atomic_t asked_again[NSIG] = {};
volatile std::sig_atomic_t checkpoint_requests = 0;

void note_stop(int signal)
{
  if (asked_again[signal])
    ::_exit(128 + signal);
  asked_again[signal] = 1;
  if (asked_to_stop == 0)
    asked_to_stop = signal;
}

void note_checkpoint(int)
{
  checkpoint_requests = checkpoint_requests + 1;
}

void handle(int signal, void (*handler)(int))
{
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  ::sigaction(signal, &action, nullptr);
}

char const* name_of(int signal)
{
  return signal == SIGINT ? "SIGINT" : signal == SIGTERM ? "SIGTERM" : "SIGUSR1";
}

double seconds_since_start()
{
  return std::chrono::duration<double>(Clock::now() - program_start).count();
}

// The time of RICOCHET_STOP_AT on the clock of the program.
std::optional<double> stop_of_environment()
{
  char const* const text = std::getenv("RICOCHET_STOP_AT");
  if (!text || !*text)
    return std::nullopt;
  double at = 0;
  if (parse_decimal(text, at) != NumberError::none)
    throw Failure(Exit::usage, fmt::format("RICOCHET_STOP_AT: found {} (allowed: seconds since "
                                           "1970, as `date +%s` gives)",
                                           in_quotes(text)));
  std::chrono::duration<double> const now = std::chrono::system_clock::now().time_since_epoch();
  return seconds_since_start() + at - now.count();
}

} // namespace

std::optional<double> parse_duration(std::string const& text)
{
  std::size_t const dash = text.find('-');
  std::string const days = dash == std::string::npos ? "0" : text.substr(0, dash);
  std::string const clock = dash == std::string::npos ? text : text.substr(dash + 1);
  std::size_t const first = clock.find(':'), second = clock.rfind(':');
  if (first == std::string::npos || first == second)
    return std::nullopt;
  double seconds = 0;
  std::pair<std::string, double> const parts[] = {{days, 86400},
                                                  {clock.substr(0, first), 3600},
                                                  {clock.substr(first + 1, second - first - 1), 60},
                                                  {clock.substr(second + 1), 1}};
  for (auto const& [digits, unit] : parts) {
    std::int64_t number = 0;
    if (digits.find_first_not_of("0123456789") != std::string::npos ||
        parse_integer(digits, number) != NumberError::none)
      return std::nullopt;
    seconds += static_cast<double>(number) * unit;
  }
  return seconds;
}

StopRequests::StopRequests(std::optional<double> walltime, std::string stop_file)
  : limit_(walltime), stop_file_(std::move(stop_file))
{
  if (auto const at = stop_of_environment())
    limit_ = std::min(limit_.value_or(*at), *at);
  asked_to_stop = checkpoint_requests = 0;
  for (int const signal : stop_signals) {
    asked_again[signal] = 0;
    handle(signal, note_stop);
  }
  handle(SIGUSR2, note_checkpoint);
}

StopRequests::~StopRequests()
{
  for (int const signal : stop_signals)
    handle(signal, SIG_DFL);
  handle(SIGUSR2, SIG_DFL);
}

std::string StopRequests::reason(double reserve, bool signals_only) const
{
  if (signal() != 0)
    return name_of(signal());
  if (signals_only)
    return "";
  if (limit_ && seconds_since_start() + reserve >= *limit_)
    return "the end of its time";
  if (!stop_file_.empty() && ::access(stop_file_.c_str(), F_OK) == 0)
    return fmt::format("the file '{}', which is to be removed before the run can go on",
                       stop_file_);
  return "";
}

int StopRequests::signal() const
{
  return asked_to_stop;
}

int StopRequests::checkpoints_asked() const
{
  return checkpoint_requests;
}

} // namespace ricochet::driver
