#include "trajectory_reader.hpp"

#include "exit_codes.hpp"
#include "input_file.hpp"
#include "journaled_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>

namespace ricochet::driver {

namespace {

// The group of the particles: ours, else the only one.
std::string particle_group(hid_t file)
{
  std::string ours = "/particles/trajectory";
  if (hdf5::exists(file, ours))
    return ours;
  if (!hdf5::exists(file, "/particles"))
    throw hdf5::Error("it has no group /particles");
  hdf5::Group const particles(H5Gopen2(file, "/particles", H5P_DEFAULT));
  char name[256] = "";
  hdf5::check(H5Lget_name_by_idx(particles, ".", H5_INDEX_NAME, H5_ITER_INC, 0, name, sizeof name,
                                 H5P_DEFAULT));
  return std::string("/particles/") + name;
}

} // namespace

bool is_hdf5(std::string const& path)
{
  char signature[8];
  return InputFile(path).read(signature, sizeof signature) == sizeof signature &&
         std::memcmp(signature, "\x89HDF\r\n\x1a\n", sizeof signature) == 0;
}

template <class Work>
auto TrajectoryReader::guarded(Work const& work) const
{
  hdf5::Turn const turn;
  try {
    return work();
  } catch (hdf5::Error const& error) {
    throw Failure(Exit::bad_data,
                  fmt::format("cannot read trajectory '{}': {}", path_, error.what()));
  }
}

TrajectoryReader::TrajectoryReader(std::string const& path) : path_(path)
{
  if (!is_hdf5(path))
    throw Failure(Exit::bad_data, fmt::format("cannot read '{}': it is not an HDF5 file", path));
  try {
    guarded([&] { open(); });
  } catch (...) {
    close();
    throw;
  }
}

TrajectoryReader::~TrajectoryReader()
{
  close();
}

void TrajectoryReader::open()
{
  // A trajectory that is being written can be read up to its last flush, but only without locks.
  ::setenv("HDF5_USE_FILE_LOCKING", "FALSE", 0);
  hdf5::Properties const journaled(H5Pcreate(H5P_FILE_ACCESS));
  set_journaled(journaled); // what a killed program did not finish is seen as if it had
  file_ = hdf5::File(H5Fopen(path_.c_str(), H5F_ACC_RDONLY, journaled));
  group_ = particle_group(file_);
  // `step` is written last: only the frames it counts are complete.
  steps_ = hdf5::read_all<std::int64_t>(file_, group_ + "/position/step");
  for (char const* const field : {"position", "velocity"}) {
    std::string const value = group_ + "/" + field + "/value";
    if (!hdf5::exists(file_, value))
      continue;
    hdf5::Properties const access(H5Pcreate(H5P_DATASET_ACCESS));
    hdf5::check(H5Pset_chunk_cache(access, 101, 8 << 20, 1.0));
    values_.emplace_back(H5Dopen2(file_, value.c_str(), access));
    hdf5::Shape const size = hdf5::shape(values_.back());
    bool const fits = size.size() == 3 && size[2] == 3 && size[0] >= steps_.size() &&
                      (fields_.empty() || static_cast<std::int64_t>(size[1]) == discs_);
    if (!fits)
      throw hdf5::Error(value + " is not a list of frames of three-dimensional vectors");
    discs_ = static_cast<std::int64_t>(size[1]);
    fields_.emplace_back(field);
  }
  if (fields_.empty())
    throw hdf5::Error("it has no positions");
}

void TrajectoryReader::close()
{
  hdf5::Turn const turn;
  values_.clear();
  file_ = hdf5::File();
}

std::vector<double> TrajectoryReader::times() const
{
  return guarded([&] {
    std::string const path = group_ + "/position/time";
    auto times =
        hdf5::exists(file_, path) ? hdf5::read_all<double>(file_, path) : std::vector<double>{};
    times.resize(std::min(times.size(), steps_.size()));
    return times;
  });
}

bool TrajectoryReader::has(std::string const& field) const
{
  return std::find(fields_.begin(), fields_.end(), field) != fields_.end();
}

void TrajectoryReader::read(std::string const& field, int component, std::int64_t frame,
                            std::int64_t first, std::int64_t count, double* values) const
{
  auto const which = std::find(fields_.begin(), fields_.end(), field) - fields_.begin();
  guarded([&] {
    if (count > 0)
      hdf5::read(values_.at(static_cast<std::size_t>(which)),
                 {static_cast<hsize_t>(frame), static_cast<hsize_t>(first),
                  static_cast<hsize_t>(component)},
                 {1, static_cast<hsize_t>(count), 1}, values);
  });
}

void TrajectoryReader::read_states(std::int64_t frame, std::vector<DiscState>& discs) const
{
  discs.assign(static_cast<std::size_t>(discs_), {});
  component_.resize(discs.size());
  auto const take = [&](char const* field, int component, double DiscState::*value) {
    if (!has(field))
      return;
    read(field, component, frame, 0, discs_, component_.data());
    for (std::size_t i = 0; i < discs.size(); ++i)
      discs[i].*value = component_[i];
  };
  take("position", 0, &DiscState::x);
  take("position", 1, &DiscState::y);
  take("velocity", 0, &DiscState::vx);
  take("velocity", 1, &DiscState::vy);
}

bool TrajectoryReader::is_single_precision(std::string const& field) const
{
  auto const which = std::find(fields_.begin(), fields_.end(), field) - fields_.begin();
  return guarded([&] {
    hdf5::Datatype const type(H5Dget_type(values_.at(static_cast<std::size_t>(which))));
    return H5Tget_size(type) == sizeof(float);
  });
}

bool TrajectoryReader::is_compressed(std::string const& field) const
{
  auto const which = std::find(fields_.begin(), fields_.end(), field) - fields_.begin();
  return guarded([&] {
    hdf5::Properties const creation(
        H5Dget_create_plist(values_.at(static_cast<std::size_t>(which))));
    return hdf5::check(H5Pget_nfilters(creation)) > 0;
  });
}

std::vector<std::string> TrajectoryReader::boundary() const
{
  return guarded([&] {
    std::vector<std::string> names;
    std::string const box = group_ + "/box";
    if (!hdf5::exists(file_, box) ||
        hdf5::check(H5Aexists_by_name(file_, box.c_str(), "boundary", H5P_DEFAULT)) <= 0)
      return names;
    hdf5::Attribute const attribute(
        H5Aopen_by_name(file_, box.c_str(), "boundary", H5P_DEFAULT, H5P_DEFAULT));
    hdf5::Datatype const type(H5Aget_type(attribute));
    if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) > 0)
      return names;
    hdf5::Dataspace const space(H5Aget_space(attribute));
    std::size_t const length = H5Tget_size(type);
    std::string packed(length * static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)),
                       '\0');
    hdf5::check(H5Aread(attribute, type, packed.data()));
    for (std::size_t i = 0; i < packed.size(); i += length)
      names.emplace_back(packed.substr(i, length).c_str());
    return names;
  });
}

std::optional<double> TrajectoryReader::parameter(char const* name) const
{
  return guarded([&]() -> std::optional<double> {
    if (!hdf5::exists(file_, "/parameters") ||
        hdf5::check(H5Aexists_by_name(file_, "/parameters", name, H5P_DEFAULT)) <= 0)
      return std::nullopt;
    hdf5::Attribute const attribute(
        H5Aopen_by_name(file_, "/parameters", name, H5P_DEFAULT, H5P_DEFAULT));
    double value = 0;
    hdf5::check(H5Aread(attribute, H5T_NATIVE_DOUBLE, &value));
    return value;
  });
}

std::string TrajectoryReader::text(std::string const& name) const
{
  return guarded([&] {
    std::string const text = hdf5::read_text(file_, "/parameters/" + name);
    return text.empty() ? hdf5::read_text_attribute(file_, "/parameters", name.c_str()) : text;
  });
}

std::string TrajectoryReader::creator(char const* attribute) const
{
  return guarded([&] { return hdf5::read_text_attribute(file_, "/h5md/creator", attribute); });
}

std::vector<double> TrajectoryReader::observable(std::string const& name) const
{
  return guarded([&] {
    std::string const path = "/observables/" + name + "/value";
    if (!hdf5::exists(file_, path))
      return std::vector<double>{};
    hdf5::Dataset const dataset(H5Dopen2(file_, path.c_str(), H5P_DEFAULT));
    if (hdf5::shape(dataset).size() != 1)
      return std::vector<double>{};
    auto values = hdf5::read_all<double>(file_, path);
    values.resize(std::min(values.size(), steps_.size()));
    return values;
  });
}

} // namespace ricochet::driver
