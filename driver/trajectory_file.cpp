#include "trajectory_file.hpp"

#include "exit_codes.hpp"
#include "journaled_file.hpp"
#include "output_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <system_error>
#include <unistd.h>

namespace ricochet::driver {

using hdf5::Dataset;
using hdf5::Group;
using hdf5::Properties;
using hdf5::Shape;

namespace {

constexpr char const* time_path = "/particles/trajectory/position/time";
constexpr char const* step_path = "/particles/trajectory/position/step";

// A component of the vectors has chunks of its own, so that those of z, which is 0 and there only
// because readers of H5MD want it, take no space.
constexpr hsize_t most_discs_per_chunk = 131072; // 1 MiB of doubles
constexpr hsize_t block_bytes = 1 << 18;         // of a component, for few discs
constexpr hsize_t series_chunk = 1024;           // numbers, for what has few a frame
constexpr int numbers_per_frame = 17;            // beside the vectors: observables, step, time
constexpr int numbers_of_edges = 9;              // more, in a periodic box

// Discs in a chunk: all, or an even share of them.
hsize_t even_chunk(hsize_t discs)
{
  hsize_t const chunks =
      std::max<hsize_t>(1, (discs + most_discs_per_chunk - 1) / most_discs_per_chunk);
  return std::max<hsize_t>(1, (discs + chunks - 1) / chunks);
}

// Creates a dataset with the same value everywhere, which takes no space in the file.
template <class T>
void create_constant(hid_t parent, char const* name, hsize_t count, T value)
{
  Properties const properties(H5Pcreate(H5P_DATASET_CREATE));
  hdf5::check(H5Pset_fill_value(properties, hdf5::native<T>(), &value));
  hdf5::Dataspace const space(H5Screate_simple(1, &count, nullptr));
  Dataset const dataset(
      H5Dcreate2(parent, name, hdf5::native<T>(), space, H5P_DEFAULT, properties, H5P_DEFAULT));
}

char const* h5md_boundary(Boundary boundary)
{
  return boundary == Boundary::periodic ? "periodic" : "none";
}

void set_frames(hid_t dataset, hsize_t frames)
{
  Shape size = hdf5::shape(dataset);
  size[0] = frames;
  hdf5::check(H5Dset_extent(dataset, size.data()));
}

Properties access_properties()
{
  Properties access(H5Pcreate(H5P_FILE_ACCESS));
  // With these bounds a killed program's file opens again; newer formats mark it as in use.
  hdf5::check(H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_V110));
  return access;
}

// The chunks of x and y of compressed vectors are open at a time; both must fit in the cache, and
// are done with once they are full.
Properties series_access()
{
  Properties access(H5Pcreate(H5P_DATASET_ACCESS));
  hdf5::check(H5Pset_chunk_cache(access, 101, 2 * block_bytes, 1.0));
  return access;
}

} // namespace

// A quantity of the whole system, one or two numbers a frame.
struct TrajectoryFile::Observable {
  char const* name;
  hsize_t columns; ///< 0: a number, k: k numbers
  double (*real)(Report const&, hsize_t column);
  std::int64_t (*integer)(Report const&); ///< instead of `real`
};

std::vector<TrajectoryFile::Observable> const& TrajectoryFile::observables()
{
  static std::vector<Observable> const all{
      {"kinetic", 0, [](Report const& r, hsize_t) { return r.energy.kinetic; }, nullptr},
      {"potential", 0, [](Report const& r, hsize_t) { return r.energy.potential; }, nullptr},
      {"lost_pairs", 0, [](Report const& r, hsize_t) { return r.energy.lost_pairs; }, nullptr},
      {"lost_walls", 0, [](Report const& r, hsize_t) { return r.energy.lost_walls; }, nullptr},
      {"numerical", 0, [](Report const& r, hsize_t) { return r.energy.numerical; }, nullptr},
      {"residual", 0, [](Report const& r, hsize_t) { return r.energy.residual(); }, nullptr},
      {"momentum", 2,
       [](Report const& r, hsize_t column) { return column == 0 ? r.momentum_x : r.momentum_y; },
       nullptr},
      {"temperature", 0, [](Report const& r, hsize_t) { return r.temperature; }, nullptr},
      {"pressure_z", 0,
       [](Report const& r, hsize_t) {
         return r.pressure_z.value_or(std::numeric_limits<double>::quiet_NaN());
       },
       nullptr},
      {"max_overlap", 0, [](Report const& r, hsize_t) { return r.max_overlap; }, nullptr},
      {"max_outside", 0, [](Report const& r, hsize_t) { return r.max_outside; }, nullptr},
      {"collisions", 0, nullptr, [](Report const& r) { return r.collisions; }},
      {"separating_hits", 0, nullptr, [](Report const& r) { return r.separating_hits; }},
      {"wall_hits", 0, nullptr, [](Report const& r) { return r.wall_hits; }},
  };
  return all;
}

ChunkSizes chunk_sizes(TrajectoryHeader const& header)
{
  auto const discs = static_cast<hsize_t>(header.discs);
  hsize_t const frame_bytes =
      std::max<hsize_t>(1, discs) * (header.float32 ? sizeof(float) : sizeof(double));
  auto const planned = static_cast<hsize_t>(std::max<std::int64_t>(1, header.frames));
  return {even_chunk(discs), static_cast<std::int64_t>(std::min(
                                 planned, std::max<hsize_t>(1, block_bytes / frame_bytes)))};
}

double forecast_bytes(TrajectoryHeader const& header)
{
  constexpr double deflated = 0.85;  // of numbers whose last digits are random
  constexpr double metadata = 60e3;  // groups, texts, and the index of a few chunks
  constexpr double chunk_entry = 90; // in the index
  ChunkSizes const chunk = chunk_sizes(header);
  auto const whole = [](double count, double size) { return std::ceil(count / size) * size; };
  auto const frames = static_cast<double>(header.frames), discs = static_cast<double>(header.discs);
  auto const per_chunk = static_cast<double>(chunk.discs);
  double const numbers = whole(frames, static_cast<double>(chunk.frames)) *
                         whole(discs, per_chunk) * (header.velocity ? 4 : 2);
  double const chunks = numbers / (static_cast<double>(chunk.frames) * per_chunk);
  double const number = header.float32 ? sizeof(float) : sizeof(double);
  double const in_series = std::min(frames, static_cast<double>(series_chunk));
  return numbers * number * (header.deflate ? deflated : 1) + chunks * chunk_entry +
         discs * sizeof(std::int64_t) +
         numbers_per_frame * whole(frames, in_series) * sizeof(double) + metadata;
}

TrajectoryFile::TrajectoryFile(TrajectoryHeader const& header)
  : header_(header),
    discs_(static_cast<hsize_t>(header.discs)),
    discs_per_chunk_(chunk_sizes(header).discs),
    frames_per_block_(chunk_sizes(header).frames)
{
  try {
    guarded([&] {
      if (header_.kept == 0)
        create();
      open();
    });
  } catch (Failure const&) {
    ::unlink(hidden_beside(header.path, "tmp").c_str());
    throw;
  }
}

TrajectoryFile::~TrajectoryFile()
{
  hdf5::Turn const turn;
  for (Dataset* dataset : series())
    *dataset = Dataset();
  file_ = hdf5::File();
}

// Runs `work`; if the file cannot be written, lets go of it and reports a Failure.
template <class Work>
void TrajectoryFile::guarded(Work const& work)
{
  hdf5::Turn const turn;
  std::string reason;
  try {
    return work();
  } catch (hdf5::Error const& error) {
    reason = error.what();
  } catch (std::system_error const& error) {
    reason = error.code().message();
  }
  bool const created = file_ >= 0;
  abandon();
  throw Failure(created ? Exit::io_error : Exit::cannot_create,
                fmt::format("cannot {} trajectory '{}': {}", created ? "write" : "create",
                            header_.path, reason));
}

// HDF5 goes on flushing after a write that failed, and closing flushes: what was good before would
// not be afterwards. So room is made sure of before anything is changed.
void TrajectoryFile::reserve(std::uint64_t bytes)
{
  constexpr std::uint64_t metadata = 1 << 19; // chunks of the observables included
  hsize_t size = 0;
  hdf5::check(H5Fget_filesize(file_, &size));
  space_.reserve(size + bytes + metadata);
}

// Leaves the file without closing it, which would write to it once more, as the last flush made it.
// Should a write have failed in spite of reserve(), then the file may claim to be longer than it
// is, and nobody would open it; its frames are there nevertheless.
void TrajectoryFile::abandon()
{
  hsize_t size = 0;
  if (file_ >= 0 && H5Fget_filesize(file_, &size) >= 0)
    space_.release(size);
  tidy_journal(header_.path);
  for (Dataset* dataset : series())
    dataset->abandon();
  file_.abandon();
}

// What stands at the path has its head at least, however early the program is killed.
void TrajectoryFile::create()
{
  if (!header_.replace && std::filesystem::exists(header_.path))
    throw std::system_error(EEXIST, std::generic_category());
  std::string const temporary = hidden_beside(header_.path, "tmp");
  file_ = hdf5::File(H5Fcreate(temporary.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access_properties()));
  space_ = DiskSpace(temporary);
  std::uint64_t bytes = discs_ * sizeof(std::int64_t); // ids
  for (auto const& [name, text] : header_.texts)
    bytes += name.size() + text.size();
  reserve(bytes);

  Group const h5md = hdf5::create_group(file_, "/h5md");
  hdf5::write_attribute<std::int32_t>(h5md, "version", std::vector<std::int32_t>{1, 1});
  hdf5::write_text_attribute(hdf5::create_group(h5md, "author"), "name", "unknown");
  Group const creator = hdf5::create_group(h5md, "creator");
  hdf5::write_text_attribute(creator, "name", "ricochet");
  hdf5::write_text_attribute(creator, "version", header_.version);

  create_particles();
  create_observables();
  create_parameters();
  file_.reset();
  space_.release();
  forget_journal(header_.path);
  put_in_place(temporary, header_.path); // who still reads an old file keeps it
}

// Opens the file to go on after the frames that are to be kept.
void TrajectoryFile::open()
{
  Properties const access = access_properties();
  set_journaled(access);
  file_ = hdf5::File(H5Fopen(header_.path.c_str(), H5F_ACC_RDWR, access));
  space_ = DiskSpace(header_.path);
  reserve(0);
  step_ = open_series(step_path);
  time_ = open_series(time_path);
  position_ = open_vectors("/particles/trajectory/position/value");
  if (header_.velocity)
    velocity_ = open_vectors("/particles/trajectory/velocity/value");
  if (hdf5::exists(file_, "/particles/trajectory/box/edges"))
    edges_ = open_series("/particles/trajectory/box/edges/value");
  for (Observable const& observable : observables())
    elements_.push_back(
        {open_series(std::string("/observables/") + observable.name + "/value"), &observable});

  auto const steps = hdf5::read_all<std::int64_t>(file_, step_path);
  auto const kept = static_cast<std::size_t>(header_.kept);
  if (steps.size() < kept)
    throw hdf5::Error(
        fmt::format("it has {} of the {} frames that the checkpoint counts", steps.size(), kept));
  for (Dataset* dataset : series())
    set_frames(*dataset, kept);
  hdf5::check(H5Fflush(file_, H5F_SCOPE_LOCAL));
  space_ = DiskSpace(header_.path); // a file that is cut has lost what was reserved behind its end
  reserve(0);
  frames_ = header_.kept;
}

void TrajectoryFile::create_series(hid_t parent, char const* name, hid_t type, Shape row,
                                   Shape chunk, bool deflate)
{
  Shape size{0}, most{H5S_UNLIMITED};
  size.insert(size.end(), row.begin(), row.end());
  most.insert(most.end(), row.begin(), row.end());
  hdf5::Dataspace const space(
      H5Screate_simple(static_cast<int>(size.size()), size.data(), most.data()));

  Properties const creation(H5Pcreate(H5P_DATASET_CREATE));
  hdf5::check(H5Pset_chunk(creation, static_cast<int>(chunk.size()), chunk.data()));
  if (deflate) {
    hdf5::check(H5Pset_shuffle(creation));
    hdf5::check(H5Pset_deflate(creation, 1));
  }
  Dataset const dataset(H5Dcreate2(parent, name, type, space, H5P_DEFAULT, creation, H5P_DEFAULT));
}

Dataset TrajectoryFile::open_series(std::string const& path) const
{
  return Dataset(H5Dopen2(file_, path.c_str(), series_access()));
}

// Takes over how the file stores vectors: a file is gone on with as it was begun. Those that are
// not compressed go straight to their place, where copying them to a chunk first would take a third
// of the time.
Dataset TrajectoryFile::open_vectors(std::string const& path)
{
  Dataset dataset = open_series(path);
  Properties const creation(H5Dget_create_plist(dataset));
  hdf5::Datatype const type(H5Dget_type(dataset));
  hsize_t chunk[3] = {};
  header_.float32 = hdf5::check(H5Tequal(type, hdf5::native<float>())) > 0;
  if ((!header_.float32 && hdf5::check(H5Tequal(type, hdf5::native<double>())) == 0) ||
      hdf5::check(H5Pget_chunk(creation, 3, chunk)) != 3 || chunk[2] != 1)
    throw hdf5::Error("it stores vectors in another way than this version of ricochet");
  frames_per_block_ = static_cast<std::int64_t>(chunk[0]);
  discs_per_chunk_ = chunk[1];
  header_.deflate = hdf5::check(H5Pget_nfilters(creation)) > 0;
  if (header_.deflate)
    return dataset;
  Properties access(H5Pcreate(H5P_DATASET_ACCESS));
  hdf5::check(H5Pset_chunk_cache(access, 0, 0, 1.0));
  dataset.reset(); // or the first opening would decide
  return Dataset(H5Dopen2(file_, path.c_str(), access));
}

// Everything that has a row a frame.
std::vector<Dataset*> TrajectoryFile::series()
{
  std::vector<Dataset*> all;
  for (Dataset* dataset : {&step_, &time_, &position_, &velocity_, &edges_})
    if (*dataset >= 0)
      all.push_back(dataset);
  for (Element& element : elements_)
    all.push_back(&element.value);
  return all;
}

// H5MD wants elements that are sampled together to share their axes.
void TrajectoryFile::link_time(hid_t element)
{
  hdf5::check(H5Lcreate_hard(file_, step_path, element, "step", H5P_DEFAULT, H5P_DEFAULT));
  hdf5::check(H5Lcreate_hard(file_, time_path, element, "time", H5P_DEFAULT, H5P_DEFAULT));
}

void TrajectoryFile::create_particles()
{
  hsize_t const planned = static_cast<hsize_t>(std::max<std::int64_t>(1, header_.frames));
  hid_t const real = header_.float32 ? hdf5::native<float>() : hdf5::native<double>();
  Shape const row{discs_, 3};
  Shape const chunk{static_cast<hsize_t>(frames_per_block_), discs_per_chunk_, 1};
  Group const group = hdf5::create_group(file_, "/particles/trajectory");

  Group const position = hdf5::create_group(group, "position");
  create_series(position, "value", real, row, chunk, header_.deflate);
  create_series(position, "step", hdf5::native<std::int64_t>(), {},
                {std::min(planned, series_chunk)});
  create_series(position, "time", hdf5::native<double>(), {}, {std::min(planned, series_chunk)});
  if (header_.velocity) {
    Group const velocity = hdf5::create_group(group, "velocity");
    create_series(velocity, "value", real, row, chunk, header_.deflate);
    link_time(velocity);
  }

  Box const& box = header_.model.box;
  Group const box_group = hdf5::create_group(group, "box");
  hdf5::write_attribute<std::int32_t>(box_group, "dimension", 3);
  hdf5::write_text_attribute(
      box_group, "boundary",
      std::vector<std::string>{h5md_boundary(box.x), h5md_boundary(box.y), "none"});
  if (box.x == Boundary::periodic || box.y == Boundary::periodic) {
    Group const edges = hdf5::create_group(box_group, "edges");
    create_series(edges, "value", hdf5::native<double>(), {3, 3},
                  {std::min(planned, series_chunk), 3, 3});
    link_time(edges);
  }

  Dataset const id = hdf5::create_list<std::int64_t>(group, "id", {discs_});
  std::vector<std::int64_t> ids;
  for (hsize_t first = 0; first < discs_; first += ids.size()) {
    ids.resize(std::min(discs_ - first, most_discs_per_chunk));
    for (std::size_t i = 0; i < ids.size(); ++i)
      ids[i] = static_cast<std::int64_t>(first + i);
    hdf5::write(id, {first}, {ids.size()}, ids.data());
  }
  create_constant<std::int32_t>(group, "species", discs_, 0);
  create_constant<double>(group, "mass", discs_, 1);
  create_constant<double>(group, "radius", discs_, header_.model.radius);
}

void TrajectoryFile::create_observables()
{
  hsize_t const planned = static_cast<hsize_t>(std::max<std::int64_t>(1, header_.frames));
  for (Observable const& observable : observables()) {
    Group const group = hdf5::create_group(file_, std::string("/observables/") + observable.name);
    Shape row, chunk{std::min(planned, series_chunk)};
    if (observable.columns > 0) {
      row.push_back(observable.columns);
      chunk.push_back(observable.columns);
    }
    hid_t const type = observable.real ? hdf5::native<double>() : hdf5::native<std::int64_t>();
    create_series(group, "value", type, row, chunk);
    link_time(group);
  }
}

void TrajectoryFile::create_parameters()
{
  Group const group = hdf5::create_group(file_, "/parameters");
  for (auto const& [name, text] : header_.texts)
    hdf5::write_text(group, name.c_str(), text);

  Model const& model = header_.model;
  hdf5::write_attribute(group, "gravity", model.gravity);
  hdf5::write_attribute(group, "restitution", model.contact.restitution);
  hdf5::write_attribute(group, "friction", model.contact.friction);
  hdf5::write_attribute(group, "width", model.box.width);
  hdf5::write_attribute(group, "height", model.box.height);
  hdf5::write_attribute(group, "radius", model.radius);
  hdf5::write_attribute(group, "dt", header_.method.dt);
  hdf5::write_attribute(group, "steps", header_.steps);
  hdf5::write_attribute(group, "every", header_.every);
  hdf5::write_text_attribute(group, "engine", name(header_.method.engine));
  hdf5::write_text_attribute(group, "law", name_of_law(model.contact));
  hdf5::write_text_attribute(group, "precision", name(header_.method.precision));

  // VMD's H5MD plugin takes the size and the name of what it draws from here.
  Group const vmd = hdf5::create_group(group, "vmd_structure");
  create_constant<std::int32_t>(vmd, "indexOfSpecies", 1, 0);
  create_constant<float>(vmd, "radius", 1, static_cast<float>(model.radius));
  hdf5::Datatype const name16(H5Tcopy(H5T_C_S1));
  hdf5::check(H5Tset_size(name16, 16));
  char const label[16] = "disc";
  hsize_t const one = 1;
  hdf5::Dataspace const space(H5Screate_simple(1, &one, nullptr));
  for (char const* name : {"name", "type"}) {
    Dataset const dataset(
        H5Dcreate2(vmd, name, name16, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    hdf5::check(H5Dwrite(dataset, name16, H5S_ALL, H5S_ALL, H5P_DEFAULT, label));
  }
}

void TrajectoryFile::append(std::vector<std::unique_ptr<Frame>> const& frames)
{
  if (frames.empty())
    return;
  // Chunks that are new; or, of compressed ones, which move when they grow, all.
  auto const blocks_of = [&](std::int64_t count) {
    return (count + frames_per_block_ - 1) / frames_per_block_;
  };
  auto const end = frames_ + static_cast<std::int64_t>(frames.size());
  auto const blocks = static_cast<std::uint64_t>(
      blocks_of(end) - (header_.deflate ? frames_ / frames_per_block_ : blocks_of(frames_)));
  std::uint64_t const chunks = (discs_ + discs_per_chunk_ - 1) / discs_per_chunk_;
  std::uint64_t const numbers = blocks * static_cast<std::uint64_t>(frames_per_block_) * chunks *
                                discs_per_chunk_ * (header_.velocity ? 4 : 2);
  std::uint64_t const vectors = numbers * (header_.float32 ? sizeof(float) : sizeof(double));
  guarded([&] {
    in_memory_ +=
        frames.size() * sizeof(double) * (numbers_per_frame + (edges_ >= 0 ? numbers_of_edges : 0));
    try {
      reserve(vectors + in_memory_);
    } catch (std::system_error const&) {
      flush_file(); // into the room that was made before
      throw;
    }
    write_frames(frames);
    if (header_.deflate) // for compressed chunks wait in memory, too
      flush_file();
  });
}

void TrajectoryFile::flush()
{
  guarded([&] { flush_file(); });
}

void TrajectoryFile::flush_file()
{
  hdf5::check(H5Fflush(file_, H5F_SCOPE_LOCAL));
  in_memory_ = 0;
}

void TrajectoryFile::write_frames(std::vector<std::unique_ptr<Frame>> const& frames)
{
  if (header_.float32)
    write_vectors(frames, buffer32_);
  else
    write_vectors(frames, buffer64_);
  if (edges_ >= 0)
    write_edges(frames);
  for (Element const& element : elements_) {
    Observable const& observable = *element.observable;
    if (observable.real)
      write_series<double>(element.value, frames, observable.columns, observable.real);
    else
      write_series<std::int64_t>(element.value, frames, 0, [&](Report const& report, hsize_t) {
        return observable.integer(report);
      });
  }
  write_series<double>(time_, frames, 0, [](Report const& report, hsize_t) { return report.time; });

  // `step` says how many frames there are, so it is the last to know of more.
  write_series<std::int64_t>(step_, frames, 0,
                             [](Report const& report, hsize_t) { return report.steps; });
  frames_ += static_cast<std::int64_t>(frames.size());
}

// Writes the components of all discs' vectors, each to a chunk of its own. Chunks of z, which is 0,
// are not written, nor do they exist: HDF5 reads them as the fill value, unless it is told never to
// use one (H5D_FILL_TIME_NEVER).
template <class Real>
void TrajectoryFile::write_vectors(std::vector<std::unique_ptr<Frame>> const& frames,
                                   std::vector<Real>& buffer)
{
  auto const start = static_cast<hsize_t>(frames_);
  for (hid_t const dataset : {hid_t{position_}, hid_t{velocity_}})
    if (dataset >= 0)
      set_frames(dataset, start + frames.size());
  bool const are_whole = !header_.deflate && frames_ % frames_per_block_ == 0 &&
                         static_cast<std::int64_t>(frames.size()) == frames_per_block_;
  for (hsize_t first = 0; first < discs_; first += discs_per_chunk_) {
    hsize_t const count = std::min(discs_per_chunk_, discs_ - first);
    hsize_t const row = are_whole ? discs_per_chunk_ : count;
    buffer.assign(frames.size() * row, Real(0));
    auto const write = [&](hid_t dataset, hsize_t component, double DiscState::*number) {
      if (dataset < 0)
        return;
      Real* out = buffer.data();
      for (auto const& frame : frames) {
        DiscState const* const states = frame->states.data() + first;
        for (hsize_t i = 0; i < count; ++i)
          out[i] = static_cast<Real>(states[i].*number);
        out += row;
      }
      if (are_whole)
        hdf5::write_chunk(dataset, {start, first, component}, buffer);
      else
        hdf5::write(dataset, {start, first, component}, {frames.size(), count, 1}, buffer.data());
    };
    write(position_, 0, &DiscState::x);
    write(position_, 1, &DiscState::y);
    write(velocity_, 0, &DiscState::vx);
    write(velocity_, 1, &DiscState::vy);
  }
}

template <class T, class Get>
void TrajectoryFile::write_series(hid_t dataset, std::vector<std::unique_ptr<Frame>> const& frames,
                                  hsize_t columns, Get const& get)
{
  std::vector<T> values;
  for (auto const& frame : frames)
    for (hsize_t column = 0; column < std::max<hsize_t>(1, columns); ++column)
      values.push_back(get(frame->report, column));
  auto const start = static_cast<hsize_t>(frames_);
  set_frames(dataset, start + frames.size());
  if (columns > 0)
    hdf5::write(dataset, {start, 0}, {frames.size(), columns}, values.data());
  else
    hdf5::write(dataset, {start}, {frames.size()}, values.data());
}

// The box as three edge vectors a frame, the one form that all readers of H5MD understand.
void TrajectoryFile::write_edges(std::vector<std::unique_ptr<Frame>> const& frames)
{
  Box const& box = header_.model.box;
  double const depth = 2 * header_.model.radius;
  std::vector<double> values;
  for (std::size_t i = 0; i < frames.size(); ++i)
    values.insert(values.end(), {box.width, 0, 0, 0, box.height, 0, 0, 0, depth});
  auto const start = static_cast<hsize_t>(frames_);
  set_frames(edges_, start + frames.size());
  hdf5::write(edges_, {start, 0, 0}, {frames.size(), 3, 3}, values.data());
}

void TrajectoryFile::sync()
{
  guarded([&] { sync_to_disk(header_.path); });
}

void TrajectoryFile::set_end(std::int64_t last)
{
  guarded([&] {
    Group const group(H5Gopen2(file_, "/parameters", H5P_DEFAULT));
    hdf5::change_attribute(group, "steps", last);
  });
}

void TrajectoryFile::close()
{
  guarded([&] {
    for (Dataset* dataset : series())
      dataset->reset();
    file_.reset();
    space_.release();
  });
}

} // namespace ricochet::driver
