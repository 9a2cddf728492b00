#include "pictures/plot.hpp"

#include "child_process.hpp"
#include "output_file.hpp"
#include "pictures/frame_source.hpp"
#include "trajectory_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>

namespace ricochet::driver {

namespace {

// The plots; columns are those of the tables.
constexpr char const* plots = R"(
set multiplot layout 3,3
set xlabel 'time'
set title 'energy'
plot $time u 1:2 w l t 'kinetic', '' u 1:3 w l t 'potential', '' u 1:($2+$3) w l lc 'black' t 'sum'
set title 'energy ledger'
set key center right
plot $time u 1:4 w l t 'lost in pairs', '' u 1:5 w l t 'lost at walls', '' u 1:6 w l t 'numerical'
set key default
set key noautotitle
set title 'temperature'
plot [][0:*] $time u 1:7 w l notitle
set title 'pressure pV/NT'
plot $time u 1:8 w l notitle
set title 'collisions so far'
plot $time u 1:9 w l t 'of discs', '' u 1:10 w l t 'with walls'
set title 'deepest overlap so far (diameters)'
plot $time u 1:11 w l notitle
set xlabel 'speed'
set title 'speeds, later half'
plot $speeds u 1:2 w histeps t 'discs', '' u 1:3 w l t 'Maxwell'
set xlabel 'y'
set title 'packing by height, later half'
plot [][0:*] $heights u 1:2 w histeps notitle
set xlabel 'distance (diameters)'
set title 'g(r), later half'
plot $pairs u 1:2 w l notitle
unset multiplot
)";

// Tables of the frames in the later half, of a hundred of them at most.
std::vector<Table> tables_of(std::string const& path)
{
  SceneOptions input;
  input.file = path;
  auto const source = open_frames(input, Purpose::run);
  std::int64_t const frames = source->frames(), first = frames / 2;
  TrajectoryReader const file(path);
  Stage stage = source->stage();
  auto const kinetic = file.observable("kinetic");
  if (static_cast<std::int64_t>(kinetic.size()) == frames) // the first half may have been faster
    stage.fast = fast_speed(*std::max_element(kinetic.begin() + first, kinetic.end()), stage.discs);
  Statistics statistics(stage);
  std::int64_t const every = std::max<std::int64_t>(1, (frames - first) / 100);
  std::vector<DiscState> discs;
  for (std::int64_t frame = frames - 1; frame >= first; frame -= every) {
    source->read(frame, discs);
    statistics.add(discs);
  }
  return {observables_table(file), statistics.speeds(), statistics.heights(), statistics.pairs()};
}

// OUT_time.csv for OUT.csv.
std::string table_name(std::string const& path, std::string const& table)
{
  std::filesystem::path name(path);
  return name.replace_filename(fmt::format("{}_{}.csv", name.stem().string(), table)).string();
}

std::vector<std::string> table_names(std::string const& path)
{
  std::vector<std::string> names;
  for (char const* const table : {"time", "speeds", "heights", "pairs"})
    names.push_back(table_name(path, table));
  return names;
}

void write_tables(std::vector<Table> const& tables, std::string const& path, bool replace)
{
  for (Table const& table : tables) {
    OutputFile file(table_name(path, table.name), replace);
    file.write(as_csv(table));
    file.commit();
  }
}

} // namespace

std::string gnuplot_script(std::vector<Table> const& tables, std::string const& name,
                           std::string const& place)
{
  std::string quoted = place;
  for (std::size_t at = 0; (at = quoted.find('\'', at)) != std::string::npos; at += 2)
    quoted.insert(at, "'");
  bool const is_svg = std::filesystem::path(name).extension() == ".svg";
  std::string script = fmt::format("set terminal {} size 1500,1100\nset output '{}'\n",
                                   is_svg ? "svg" : "pngcairo", quoted);
  script += "set datafile separator ','\nset datafile columnheaders\n"
            "set key noautotitle\nset grid lc 'grey'\n";
  for (Table const& table : tables)
    script += fmt::format("${} << END\n{}END\n", table.name, as_csv(table));
  return script + plots;
}

Exit plot(PlotOptions const& options)
{
  std::vector<std::string> outputs{options.output};
  if (!options.csv.empty())
    for (std::string const& name : table_names(options.csv))
      outputs.push_back(name);
  check_outputs(outputs, {options.file}, options.force);
  if (!is_hdf5(options.file))
    throw Failure(Exit::bad_data,
                  fmt::format("cannot read '{}': it is not an HDF5 file", options.file));
  auto const tables = tables_of(options.file);
  if (!options.csv.empty())
    write_tables(tables, options.csv, options.force);
  if (options.output.empty())
    return Exit::done;
  if (!is_installed("gnuplot")) {
    if (options.csv.empty())
      write_tables(tables, options.output, options.force);
    std::string const data = options.csv.empty() ? options.output : options.csv;
    throw Failure(Exit::failed,
                  fmt::format("there is no gnuplot to make '{}' (install the package gnuplot-nox); "
                              "its numbers are in {} and beside it",
                              options.output, table_name(data, "time")));
  }
  OutputFile file(options.output, options.force);
  ChildProcess gnuplot({"gnuplot", "-"});
  std::string const script = gnuplot_script(tables, options.output, file.place());
  gnuplot.write(script.data(), script.size());
  gnuplot.finish();
  file.commit();
  return Exit::done;
}

} // namespace ricochet::driver
