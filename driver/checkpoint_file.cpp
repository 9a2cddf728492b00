#include "checkpoint_file.hpp"

#include "disk_space.hpp"
#include "exit_codes.hpp"
#include "hdf5.hpp"
#include "log.hpp"
#include "output_file.hpp"
#include "provenance.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <cstdio>
#include <filesystem>
#include <system_error>
#include <unistd.h>
#include <utility>
#include <vector>

namespace ricochet::driver {

namespace {

constexpr std::int64_t present_format = 3;

/// A checksum of everything in a checkpoint.
class Checksum {
 public:
  void add(void const* data, std::size_t bytes)
  {
    value_ = ::crc32_z(value_, static_cast<unsigned char const*>(data), bytes);
  }
  void add(std::string const& text) { add(text.c_str(), text.size() + 1); }
  template <class T>
  void add(std::vector<T> const& list)
  {
    add(list.data(), list.size() * sizeof(T));
  }
  std::int64_t value() const { return static_cast<std::int64_t>(value_); }

 private:
  unsigned long value_ = ::crc32_z(0, nullptr, 0);
};

/// Numbers with names as two lists, which is how a file keeps them.
template <class Number>
struct NamedList {
  std::string names; ///< a line each
  std::vector<Number> values;

  NamedList() = default;
  explicit NamedList(std::map<std::string, Number> const& numbers)
  {
    for (auto const& [name, value] : numbers) {
      names += name + "\n";
      values.push_back(value);
    }
  }
  std::map<std::string, Number> map() const
  {
    std::map<std::string, Number> numbers;
    std::size_t start = 0;
    for (Number const value : values) {
      std::size_t const end = names.find('\n', start);
      numbers[names.substr(start, end - start)] = value;
      start = end + 1;
    }
    return numbers;
  }
};

static_assert(sizeof(DiscState) == 4 * sizeof(double), "discs are stored as rows of four numbers");

std::int64_t checksum(SavedRun const& run, NamedList<std::int64_t> const& integers,
                      NamedList<double> const& reals)
{
  Checksum sum;
  for (std::string const& text :
       {run.version, run.identity, run.summary, run.summary_json, integers.names, reals.names})
    sum.add(text);
  sum.add(&run.frames, sizeof run.frames);
  sum.add(&run.wall_seconds, sizeof run.wall_seconds);
  sum.add(&run.slow_looks, sizeof run.slow_looks);
  sum.add(integers.values);
  sum.add(reals.values);
  sum.add(run.engine.discs);
  return sum.value();
}

void write_file(std::string const& path, SavedRun const& run)
{
  hdf5::Turn const turn;
  NamedList<std::int64_t> const integers(run.engine.integers);
  NamedList<double> const reals(run.engine.reals);
  hdf5::Properties const access(H5Pcreate(H5P_FILE_ACCESS));
  hdf5::check(H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_V110));
  hdf5::File file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access));
  // HDF5 reports a full disk late and not always well.
  constexpr std::uint64_t metadata = 1 << 16;
  DiskSpace space(path);
  space.reserve(run.engine.discs.size() * sizeof(DiscState) + run.identity.size() +
                run.summary.size() + run.summary_json.size() + metadata);

  hdf5::write_attribute(file, "format", present_format);
  hdf5::write_attribute(file, "checksum", checksum(run, integers, reals));
  hdf5::write_attribute(file, "frames", run.frames);
  hdf5::write_attribute(file, "wall_seconds", run.wall_seconds);
  hdf5::write_attribute(file, "slow_looks", run.slow_looks);
  hdf5::write_text(file, "version", run.version);
  hdf5::write_text(file, "identity", run.identity);
  hdf5::write_text(file, "summary", run.summary);
  hdf5::write_text(file, "summary_json", run.summary_json);
  hdf5::write_text(file, "integer_names", integers.names);
  hdf5::write_text(file, "real_names", reals.names);
  hdf5::write_list(file, "integers", integers.values);
  hdf5::write_list(file, "reals", reals.values);
  hdf5::Shape const size{run.engine.discs.size(), 4};
  hdf5::Dataset discs = hdf5::create_list<double>(file, "discs", size);
  if (size[0] > 0)
    hdf5::write(discs, {0, 0}, size, &run.engine.discs[0].x);
  discs.reset();
  file.reset();
  space.release();
}

SavedRun read_file(std::string const& path)
{
  hdf5::Turn const turn;
  SavedRun run;
  hdf5::File const file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT));
  auto const format = hdf5::read_attribute<std::int64_t>(file, "format");
  run.version = hdf5::read_text(file, "version");
  if (format != present_format || run.version != version())
    throw Failure(Exit::bad_data,
                  fmt::format("cannot go on from '{}': ricochet {} made it, with checkpoints of "
                              "format {}, and this is {} with format {}, whose results may differ: "
                              "finish with the other, or start again with --force",
                              path, run.version, format, version(), present_format));
  run.identity = hdf5::read_text(file, "identity");
  run.summary = hdf5::read_text(file, "summary");
  run.summary_json = hdf5::read_text(file, "summary_json");
  run.frames = hdf5::read_attribute<std::int64_t>(file, "frames");
  run.wall_seconds = hdf5::read_attribute<double>(file, "wall_seconds");
  run.slow_looks = hdf5::read_attribute<std::int64_t>(file, "slow_looks");
  NamedList<std::int64_t> integers;
  NamedList<double> reals;
  integers.names = hdf5::read_text(file, "integer_names");
  reals.names = hdf5::read_text(file, "real_names");
  integers.values = hdf5::read_all<std::int64_t>(file, "integers");
  reals.values = hdf5::read_all<double>(file, "reals");
  hdf5::Dataset const discs(H5Dopen2(file, "discs", H5P_DEFAULT));
  hdf5::Shape const size = hdf5::shape(discs);
  if (size.size() != 2 || size[1] != 4)
    throw hdf5::Error("'discs' is not a list of states");
  run.engine.discs.resize(size[0]);
  if (size[0] > 0)
    hdf5::read(discs, {0, 0}, size, &run.engine.discs[0].x);
  if (checksum(run, integers, reals) != hdf5::read_attribute<std::int64_t>(file, "checksum"))
    throw hdf5::Error("its checksum is wrong");
  run.engine.integers = integers.map();
  run.engine.reals = reals.map();
  return run;
}

} // namespace

std::string previous_checkpoint(std::string const& path)
{
  return path + ".prev";
}

void write_checkpoint(std::string const& path, SavedRun const& run)
{
  std::string const temporary = hidden_beside(path, "tmp");
  std::string reason;
  try {
    write_file(temporary, run);
    // Between the two renames only the one before it is there, which is a good one too.
    if (std::filesystem::exists(path) &&
        std::rename(path.c_str(), previous_checkpoint(path).c_str()) != 0)
      throw std::system_error(errno, std::generic_category());
    put_in_place(temporary, path);
    return;
  } catch (hdf5::Error const& error) {
    reason = error.what();
  } catch (std::system_error const& error) {
    reason = error.code().message();
  }
  ::unlink(temporary.c_str());
  throw Failure(Exit::io_error, fmt::format("cannot write checkpoint '{}': {}", path, reason));
}

bool is_checkpoint(std::string const& path)
{
  hdf5::Turn const turn;
  try {
    hdf5::File const file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT));
    return hdf5::check(H5Aexists(file, "checksum")) > 0;
  } catch (hdf5::Error const&) {
    return false;
  }
}

SavedRun read_checkpoint(std::string const& path)
{
  std::error_code error;
  if (!std::filesystem::exists(path, error))
    throw Failure(Exit::no_input, fmt::format("cannot open checkpoint '{}': {}", path,
                                              error ? error.message() : "there is no such file"));
  try {
    return read_file(path);
  } catch (hdf5::Error const& damage) {
    throw Failure(Exit::io_error,
                  fmt::format("checkpoint '{}' is damaged: {}", path, damage.what()));
  }
}

std::optional<SavedRun> find_checkpoint(std::string const& path)
{
  for (std::string const& candidate : {path, previous_checkpoint(path)}) {
    try {
      return read_checkpoint(candidate);
    } catch (Failure const& failure) {
      if (failure.code() == Exit::io_error)
        tell(LogLevel::warning, failure.what());
      else if (failure.code() != Exit::no_input)
        throw;
    }
  }
  return std::nullopt;
}

} // namespace ricochet::driver
