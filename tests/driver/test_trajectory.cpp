// What is written to a trajectory is read back from it, in every shape of frame and block.
#include "frame_writer.hpp"
#include "process.hpp"
#include "trajectory_file.hpp"
#include "trajectory_reader.hpp"

#include "exit_codes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <sys/resource.h>

namespace ricochet::driver {
namespace {

using test::Folder;

struct Shape {
  std::int64_t discs, frames;
  bool float32, deflate, velocity;
};

TrajectoryHeader header_for(std::string const& path, Shape const& shape)
{
  TrajectoryHeader header;
  header.path = path;
  header.discs = shape.discs;
  header.frames = shape.frames;
  header.steps = 3 * (shape.frames - 1);
  header.every = 3;
  header.float32 = shape.float32;
  header.deflate = shape.deflate;
  header.velocity = shape.velocity;
  header.version = "1.2.3";
  header.texts = {{"scene", "g=1"}, {"command_line", std::string(100000, 'c')}};
  return header;
}

// A number that is exact in single precision and differs for every place.
double number(std::int64_t frame, std::int64_t disc, int field)
{
  return static_cast<double>((frame * 7919 + disc * 31 + std::int64_t{field} * 3) % 100003) -
         50000.5;
}

void fill(Frame& frame, std::int64_t index)
{
  frame.report.steps = 3 * index;
  frame.report.time = 0.5 * static_cast<double>(index);
  frame.report.energy.kinetic = static_cast<double>(index) + 0.25;
  frame.report.collisions = 11 * index;
  for (std::size_t i = 0; i < frame.states.size(); ++i) {
    auto const disc = static_cast<std::int64_t>(i);
    frame.states[i] = {number(index, disc, 0), number(index, disc, 1), number(index, disc, 2),
                       number(index, disc, 3)};
  }
}

void write_frames(TrajectoryHeader const& header, std::int64_t end)
{
  TrajectoryFile file(header);
  FrameWriter writer(file, header.discs);
  for (std::int64_t index = header.kept; index < end; ++index) {
    auto frame = writer.borrow();
    fill(*frame, index);
    writer.submit(std::move(frame));
  }
  writer.finish();
  file.close();
}

void expect_vectors(TrajectoryReader const& file, Shape const& shape)
{
  std::vector<double> values(static_cast<std::size_t>(shape.discs));
  for (std::int64_t index = 0; index < shape.frames; ++index)
    for (int field = 0; field < (shape.velocity ? 2 : 1); ++field)
      for (int component = 0; component < 3; ++component) {
        std::fill(values.begin(), values.end(), 17); // z is not what was there before, either
        file.read(field == 0 ? "position" : "velocity", component, index, 0, shape.discs,
                  values.data());
        for (std::int64_t disc = 0; disc < shape.discs; ++disc)
          ASSERT_EQ(values[static_cast<std::size_t>(disc)],
                    component < 2 ? number(index, disc, 2 * field + component) : 0)
              << index << " " << disc << " " << component;
      }
}

class Trajectories : public testing::TestWithParam<Shape> {};

TEST_P(Trajectories, ReadBackAsTheyWereWritten)
{
  Shape const shape = GetParam();
  Folder const folder;
  write_frames(header_for(folder / "t.h5md", shape), shape.frames);

  TrajectoryReader const file(folder / "t.h5md");
  ASSERT_EQ(file.frames(), shape.frames);
  ASSERT_EQ(file.discs(), shape.discs);
  EXPECT_EQ(file.has("velocity"), shape.velocity);
  EXPECT_EQ(file.is_single_precision("position"), shape.float32);
  EXPECT_EQ(file.is_compressed("position"), shape.deflate);
  EXPECT_EQ(file.creator("version"), "1.2.3");
  EXPECT_EQ(file.text("scene"), "g=1");
  EXPECT_EQ(file.text("command_line"), std::string(100000, 'c'));
  auto const times = file.times();
  auto const kinetic = file.observable("kinetic");
  auto const collisions = file.observable("collisions");
  for (std::int64_t index = 0; index < shape.frames; ++index) {
    auto const at = static_cast<std::size_t>(index);
    ASSERT_EQ(file.steps()[at], 3 * index);
    ASSERT_EQ(times.at(at), 0.5 * static_cast<double>(index));
    ASSERT_EQ(kinetic.at(at), static_cast<double>(index) + 0.25);
    ASSERT_EQ(collisions.at(at), 11.0 * static_cast<double>(index));
  }
  expect_vectors(file, shape);
}

INSTANTIATE_TEST_SUITE_P(
    Shapes, Trajectories,
    testing::Values(Shape{0, 5, false, false, true},     // no discs
                    Shape{1, 1, false, false, true},     // one frame
                    Shape{2, 30000, false, false, true}, // 16,384 frames a block
                    Shape{1000, 73, false, false, true}, // a last block that is not full
                    Shape{1000, 40, true, false, true}, Shape{1000, 40, false, true, true},
                    Shape{1000, 40, true, true, false},
                    Shape{150001, 3, false, false, true}, // two chunks a frame, one not full
                    Shape{131073, 2, true, true, true})); // an odd share of discs

// Bytes that the file's positions take in it.
std::uint64_t stored_bytes(std::string const& path)
{
  hdf5::Turn const turn;
  hdf5::File const file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT));
  hdf5::Dataset const value(H5Dopen2(file, "/particles/trajectory/position/value", H5P_DEFAULT));
  return H5Dget_storage_size(value);
}

// Whatever a run that goes on would choose now: `compress = auto` depends on how fast the machine
// is, and other versions may cut chunks in another way.
TEST(Trajectory, AFileIsGoneOnWithAsItWasBegun)
{
  for (bool const deflate : {false, true})
    for (bool const float32 : {false, true}) {
      Folder const folder;
      Shape const begun{1000, 200, float32, deflate, true};
      write_frames(header_for(folder / "t.h5md", begun), 40);
      TrajectoryHeader other = header_for(folder / "t.h5md", {1000, 9, !float32, !deflate, true});
      other.kept = 35;
      write_frames(other, 200); // whole blocks, too: of 32 frames, or of 65
      TrajectoryReader const file(folder / "t.h5md");
      ASSERT_EQ(file.frames(), 200);
      EXPECT_EQ(file.is_single_precision("position"), float32);
      EXPECT_EQ(file.is_compressed("velocity"), deflate);
      expect_vectors(file, begun);
      std::uint64_t const frames = float32 ? 4 * 65 : 7 * 32; // of whole blocks
      std::uint64_t const plain = frames * 1000 * 2 * (float32 ? sizeof(float) : sizeof(double));
      if (deflate)
        EXPECT_LT(stored_bytes(folder / "t.h5md"), plain);
      else
        EXPECT_EQ(stored_bytes(folder / "t.h5md"), plain) << "x and y, and no z";
    }
}

// What is in the file of a writer that is still at work, as after a kill. A copy is read, because
// HDF5 shows a second reader in the same process what has not reached the file yet.
std::int64_t frames_on_disk(Folder const& folder)
{
  auto const replace = std::filesystem::copy_options::overwrite_existing;
  std::filesystem::copy_file(folder / "t.h5md", folder / "copy.h5md", replace);
  return TrajectoryReader(folder / "copy.h5md").frames();
}

TEST(Trajectory, EveryFlushedFrameIsInTheFile)
{
  Folder const folder;
  TrajectoryFile file(header_for(folder / "t.h5md", {100, 100, false, false, true}));
  EXPECT_EQ(frames_on_disk(folder), 0);
  std::vector<std::unique_ptr<Frame>> frames;
  frames.push_back(std::make_unique<Frame>());
  frames[0]->states.resize(100);
  for (std::int64_t index = 0; index < 5; ++index) {
    fill(*frames[0], index);
    file.append(frames);
    EXPECT_EQ(frames_on_disk(folder), index);
    file.flush();
    EXPECT_EQ(frames_on_disk(folder), index + 1);
  }
}

TEST(Trajectory, FramesAppearWithinSecondsWithoutAFullBlock)
{
  Folder const folder;
  TrajectoryHeader const header = header_for(folder / "t.h5md", {2, 30000, false, false, true});
  TrajectoryFile file(header);
  FrameWriter writer(file, header.discs);
  ASSERT_GT(file.frames_per_block(), 1000);
  for (int index = 0; index < 3; ++index) {
    auto frame = writer.borrow();
    fill(*frame, index);
    writer.submit(std::move(frame));
  }
  std::int64_t seen = 0;
  for (int tenths = 0; tenths < 100 && seen < 3; ++tenths) {
    ::usleep(100000);
    try {
      seen = frames_on_disk(folder);
    } catch (Failure const&) {
      // Copied amid a flush.
    }
  }
  EXPECT_EQ(seen, 3);
}

TEST(Trajectory, APeriodicBoxHasTimeDependentEdgesAndWallsHaveNone)
{
  Folder const folder;
  for (bool const periodic : {false, true}) {
    TrajectoryHeader header = header_for(folder / "t.h5md", {2, 3, false, false, true});
    header.replace = true;
    header.model.box.width = 50;
    header.model.box.x = periodic ? Boundary::periodic : Boundary::walls;
    write_frames(header, header.frames);

    TrajectoryReader const reader(folder / "t.h5md");
    EXPECT_EQ(reader.boundary(),
              (std::vector<std::string>{periodic ? "periodic" : "none", "none", "none"}));
    hdf5::File const file(H5Fopen((folder / "t.h5md").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT));
    std::string const edges = "/particles/trajectory/box/edges";
    ASSERT_EQ(hdf5::exists(file, edges), periodic);
    if (!periodic)
      continue;
    hdf5::Dataset const value(H5Dopen2(file, (edges + "/value").c_str(), H5P_DEFAULT));
    ASSERT_EQ(hdf5::shape(value), (hdf5::Shape{3, 3, 3}));
    std::vector<double> last(9);
    hdf5::read(value, {2, 0, 0}, {1, 3, 3}, last.data());
    EXPECT_EQ(last, (std::vector<double>{50, 0, 0, 0, 740, 0, 0, 0, 6}));
    EXPECT_EQ(hdf5::read_all<std::int64_t>(file, edges + "/step"), reader.steps());
  }
}

TEST(Trajectory, AnExistingFileIsKeptUnlessReplaced)
{
  Folder const folder;
  folder.write("t.h5md", "precious");
  TrajectoryHeader header = header_for(folder / "t.h5md", {2, 1, false, false, true});
  try {
    TrajectoryFile const file(header);
    FAIL();
  } catch (Failure const& failure) {
    EXPECT_EQ(failure.code(), Exit::cannot_create) << failure.what();
  }
  EXPECT_EQ(test::text_of(folder / "t.h5md"), "precious");
  header.replace = true;
  write_frames(header, header.frames);
  EXPECT_EQ(TrajectoryReader(folder / "t.h5md").frames(), 1);
}

TEST(Trajectory, AFailureToWriteReachesWhoHandsFramesOver)
{
  rlimit old{};
  ::getrlimit(RLIMIT_FSIZE, &old);
  auto const handler = std::signal(SIGXFSZ, SIG_IGN);
  Folder const folder;
  Exit code = Exit::done;
  {
    TrajectoryHeader const header = header_for(folder / "t.h5md", {1000, 1000, false, false, true});
    TrajectoryFile file(header);
    rlimit const small{8 << 20, old.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &small);
    try {
      FrameWriter writer(file, header.discs);
      for (std::int64_t index = 0; index < header.frames; ++index) {
        auto frame = writer.borrow();
        fill(*frame, index);
        writer.submit(std::move(frame));
      }
      writer.finish();
    } catch (Failure const& failure) {
      code = failure.code();
      EXPECT_NE(std::string(failure.what()).find("File too large"), std::string::npos)
          << failure.what();
    }
  }
  ::setrlimit(RLIMIT_FSIZE, &old);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(code, Exit::io_error);
  TrajectoryReader const file(folder / "t.h5md");
  EXPECT_GT(file.frames(), 0);
  EXPECT_LT(file.frames(), 1000);
}

TEST(Trajectory, WhatIsNotATrajectoryIsBadData)
{
  Folder const folder;
  for (std::string const& path :
       {folder.write("a", "1,2,3,4"), folder.write("b", "\x89HDF\r\n\x1a\n")}) {
    try {
      TrajectoryReader const file(path);
      FAIL();
    } catch (Failure const& failure) {
      EXPECT_EQ(failure.code(), Exit::bad_data) << failure.what();
    }
  }
}

} // namespace
} // namespace ricochet::driver
