// Writing a trajectory: an H5MD 1.1 file that keeps every flushed frame whatever kills the program.
//
// driver/README.md describes the layout for users.
#pragma once

#include "disk_space.hpp"
#include "hdf5.hpp"

#include "ricochet/engine.hpp"

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace ricochet::driver {

/// What is known about a trajectory before its first frame.
struct TrajectoryHeader {
  std::string path;
  bool replace = false;  ///< an existing file
  std::int64_t kept = 0; ///< frames of an existing file to go on after; 0: a new file
  Model model;
  Method method;
  std::int64_t discs = 0;
  std::int64_t steps = 0;  ///< how many are planned
  std::int64_t every = 1;  ///< from frame to frame
  std::int64_t frames = 0; ///< how many are planned
  bool velocity = true;    ///< beside the positions
  bool float32 = false;    ///< positions and velocities in single precision
  bool deflate = false;    ///< compress them
  std::string version;     ///< of this program
  std::vector<std::pair<std::string, std::string>> texts; ///< stored below /parameters
};

/// About how many bytes the file will have.
double forecast_bytes(TrajectoryHeader const& header);

/// How frames are cut into chunks.
struct ChunkSizes {
  std::uint64_t discs; ///< in a chunk: all, or an even share of them
  std::int64_t frames; ///< in a chunk
};
ChunkSizes chunk_sizes(TrajectoryHeader const& header);

/// One frame: the discs in id order, and the report of the same moment.
struct Frame {
  Report report;
  std::vector<DiscState> states;
};

/// A trajectory that is being written. The functions throw Failure; after that nothing but the
/// destructor may be called, which leaves the file as the last good flush left it.
class TrajectoryFile {
 public:
  explicit TrajectoryFile(TrajectoryHeader const& header);
  ~TrajectoryFile();

  /// Frames that share a chunk of the file: handing over so many at a time is cheapest.
  std::int64_t frames_per_block() const { return frames_per_block_; }

  /// Frames appended so far.
  std::int64_t frames() const { return frames_; }

  /// Appends `frames`. Where there is no room for them, those before are flushed.
  void append(std::vector<std::unique_ptr<Frame>> const& frames);

  /// Makes all appended frames part of the file, whatever happens to the program from now on.
  void flush();

  /// Has all flushed frames written to the disk.
  void sync();

  /// Notes that the run ended after step `last`, before its planned end.
  void set_end(std::int64_t last);

  /// Completes the file.
  void close();

 private:
  struct Observable;
  struct Element {
    hdf5::Dataset value;
    Observable const* observable = nullptr;
  };

  static std::vector<Observable> const& observables();

  template <class Work>
  void guarded(Work const& work);
  void create();
  void open();
  hdf5::Dataset open_series(std::string const& path) const;
  hdf5::Dataset open_vectors(std::string const& path);
  std::vector<hdf5::Dataset*> series();
  void create_particles();
  void create_observables();
  void create_parameters();
  static void create_series(hid_t parent, char const* name, hid_t type, hdf5::Shape row,
                            hdf5::Shape chunk, bool deflate = false);
  void link_time(hid_t element);
  template <class Real>
  void write_vectors(std::vector<std::unique_ptr<Frame>> const& frames, std::vector<Real>& buffer);
  void write_frames(std::vector<std::unique_ptr<Frame>> const& frames);
  template <class T, class Get>
  void write_series(hid_t dataset, std::vector<std::unique_ptr<Frame>> const& frames,
                    hsize_t columns, Get const& get);
  void write_edges(std::vector<std::unique_ptr<Frame>> const& frames);
  void reserve(std::uint64_t bytes);
  void flush_file();
  void abandon();

  TrajectoryHeader header_;
  hsize_t discs_;
  hsize_t discs_per_chunk_;       ///< of vectors
  std::int64_t frames_per_block_; ///< and of these
  std::int64_t frames_ = 0;
  std::uint64_t in_memory_ = 0; ///< bytes of appended frames that may not have a place in the file
  DiskSpace space_;
  hdf5::File file_;
  hdf5::Dataset step_, time_, position_, velocity_, edges_;
  std::vector<Element> elements_;
  std::vector<double> buffer64_;
  std::vector<float> buffer32_;
};

} // namespace ricochet::driver
