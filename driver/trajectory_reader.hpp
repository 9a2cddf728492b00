// Reading trajectories: ours, and other H5MD files as far as they have the same parts.
#pragma once

#include "hdf5.hpp"

#include "ricochet/model.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace ricochet::driver {

/// True if the file at `path` is an HDF5 file.
bool is_hdf5(std::string const& path);

class TrajectoryReader {
 public:
  /// Throws Failure: Exit::no_input, or Exit::bad_data if it is not a trajectory.
  explicit TrajectoryReader(std::string const& path);
  ~TrajectoryReader();
  TrajectoryReader(TrajectoryReader const&) = delete;
  TrajectoryReader& operator=(TrajectoryReader const&) = delete;

  std::string const& path() const { return path_; }
  std::int64_t frames() const { return static_cast<std::int64_t>(steps_.size()); }
  std::int64_t discs() const { return discs_; }
  std::vector<std::int64_t> const& steps() const { return steps_; } ///< one a frame
  std::vector<double> times() const;                                ///< empty if not stored

  /// Elements of the particles, such as "position", that have vectors in every frame.
  std::vector<std::string> const& fields() const { return fields_; }
  bool has(std::string const& field) const;

  /// A component, 0 to 2, of the vectors of the discs from `first` on in `frame`.
  void read(std::string const& field, int component, std::int64_t frame, std::int64_t first,
            std::int64_t count, double* values) const;

  /// The discs in `frame`, in place of `discs`; without "velocity" in the file they are at rest.
  void read_states(std::int64_t frame, std::vector<DiscState>& discs) const;

  bool is_single_precision(std::string const& field) const;
  bool is_compressed(std::string const& field) const;
  std::vector<std::string> boundary() const;

  /// A number of /parameters, if it is there.
  std::optional<double> parameter(char const* name) const;
  /// A text of /parameters, or an attribute of it; "" if it is not there.
  std::string text(std::string const& name) const;
  /// A text attribute of /h5md/creator.
  std::string creator(char const* attribute) const;

  /// An observable's numbers, one a frame; empty if there is none or it is not of that kind.
  std::vector<double> observable(std::string const& name) const;

 private:
  template <class Work>
  auto guarded(Work const& work) const;
  void open();
  void close();

  std::string path_;
  hdf5::File file_;
  std::string group_; ///< of the particles
  std::int64_t discs_ = 0;
  std::vector<std::int64_t> steps_;
  std::vector<std::string> fields_;
  std::vector<hdf5::Dataset> values_;     ///< by field
  mutable std::vector<double> component_; ///< that was read last, kept for its memory
};

} // namespace ricochet::driver
