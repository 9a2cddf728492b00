// The program `ricochet`: understands the command line, runs the command, reports failure.
#include "command_line.hpp"
#include "compare.hpp"
#include "cpu_check.hpp"
#include "ensemble.hpp"
#include "exit_codes.hpp"
#include "generate.hpp"
#include "info.hpp"
#include "log.hpp"
#include "output_file.hpp"
#include "pictures/plot.hpp"
#include "pictures/render.hpp"
#include "run.hpp"
#include "validate.hpp"

#include <csignal>
#include <cstdio>
#include <new>

using namespace ricochet::driver;

namespace {

struct Execute {
  Exit operator()(RunOptions const& options) const { return run(options); }
  Exit operator()(GenerateOptions const& options) const { return generate(options); }
  Exit operator()(ValidateOptions const& options) const { return validate(options); }
  Exit operator()(InfoOptions const& options) const { return info(options); }
  Exit operator()(CompareOptions const& options) const { return compare(options); }
  Exit operator()(RenderOptions const& options) const { return render(options); }
  Exit operator()(EnsembleOptions const& options) const { return ensemble(options); }
  Exit operator()(PlotOptions const& options) const { return plot(options); }
  Exit operator()(KokkosHelp) const
  {
    print_kokkos_help();
    return Exit::done;
  }
  Exit operator()(Answer const& answer) const
  {
    OutputFile out("-", false);
    out.write(answer.text);
    out.commit();
    return Exit::done;
  }
};

int fail(Exit code, char const* message)
{
  tell(LogLevel::error, message);
  return static_cast<int>(code);
}

int run_command(std::vector<std::string> const& arguments)
{
  try {
    return static_cast<int>(std::visit(Execute{}, parse_command_line(arguments)));
  } catch (BadScene const& problems) {
    if (log_format() == LogFormat::json)
      return fail(problems.code(), problems.what());
    std::fprintf(stderr, "%s\n", problems.what());
    return static_cast<int>(problems.code());
  } catch (Failure const& failure) {
    return fail(failure.code(), failure.what());
  } catch (std::bad_alloc const&) {
    return fail(Exit::failed, "not enough memory for this scene");
  } catch (std::exception const& error) {
    return fail(Exit::internal, error.what());
  }
}

} // namespace

int main(int argc, char** argv)
{
  if (char const* const feature = missing_cpu_feature()) {
    std::fprintf(stderr, "ricochet: this processor lacks %s\n", feature);
    return static_cast<int>(Exit::internal);
  }
  std::signal(SIGXFSZ, SIG_IGN); // a file that may not grow further is an error like a full disk
  std::signal(SIGPIPE, SIG_IGN); // and so is a reader that went away
  int const code = run_command({argv + 1, argv + argc});
  log_end(code);
  return code;
}
