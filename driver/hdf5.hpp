// The HDF5 C interface with owners for its handles and exceptions for its errors.
//
// HDF5 is thread-safe or not as it was built; here threads take turns.
#pragma once

#include <hdf5.h>

#include <cstdint>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace ricochet::driver::hdf5 {

/// A call failed; what() says what HDF5, or the system below it, gave as the reason.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Returns `result` unless it is negative, which is how HDF5 reports an error; then throws Error.
template <class Result>
Result check(Result result);

[[noreturn]] void throw_error();

template <class Result>
Result check(Result result)
{
  if (result < 0)
    throw_error();
  return result;
}

/// A thread's turn at HDF5: whatever uses the library does so while it holds one, which it may do
/// several times over. Errors are then thrown, not printed, and files that could not be written are
/// not touched again when the program ends.
class Turn {
 public:
  Turn();

 private:
  std::lock_guard<std::recursive_mutex> lock_;
};

/// Owns a handle.
template <herr_t (*close)(hid_t)>
class Handle {
 public:
  Handle() = default;
  explicit Handle(hid_t id) : id_(check(id)) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)) {}
  Handle& operator=(Handle&& other) noexcept
  {
    std::swap(id_, other.id_);
    return *this;
  }
  ~Handle()
  {
    if (id_ >= 0)
      close(id_);
  }
  // The C functions take handles as they are.
  operator hid_t() const { return id_; } // NOLINT(google-explicit-constructor)

  /// Gives up the handle without closing it.
  void abandon() { id_ = -1; }

  /// Closes the handle now. Throws Error.
  void reset()
  {
    if (id_ >= 0)
      check(close(std::exchange(id_, -1)));
  }

 private:
  hid_t id_ = -1;
};

using File = Handle<H5Fclose>;
using Group = Handle<H5Gclose>;
using Dataset = Handle<H5Dclose>;
using Dataspace = Handle<H5Sclose>;
using Datatype = Handle<H5Tclose>;
using Properties = Handle<H5Pclose>;
using Attribute = Handle<H5Aclose>;

using Shape = std::vector<hsize_t>;

/// HDF5's name for a C++ type in memory.
template <class T>
hid_t native();
template <>
inline hid_t native<double>()
{
  return H5T_NATIVE_DOUBLE;
}
template <>
inline hid_t native<float>()
{
  return H5T_NATIVE_FLOAT;
}
template <>
inline hid_t native<std::int32_t>()
{
  return H5T_NATIVE_INT32;
}
template <>
inline hid_t native<std::int64_t>()
{
  return H5T_NATIVE_INT64;
}

/// A group made at `path`, with the groups above it.
Group create_group(hid_t parent, std::string const& path);

bool exists(hid_t parent, std::string const& path);

/// Shape of a dataset.
Shape shape(hid_t dataset);

// Text is of fixed length, as H5MD asks.
void write_text_attribute(hid_t object, char const* name, std::string const& text);
void write_text_attribute(hid_t object, char const* name, std::vector<std::string> const& texts);
void write_text(hid_t parent, char const* name, std::string const& text);
/// Texts of fixed and of variable length; "" if there is no such dataset or attribute.
std::string read_text(hid_t parent, std::string const& path);
std::string read_text_attribute(hid_t parent, std::string const& path, char const* name);

template <class T>
void write_attribute(hid_t object, char const* name, std::vector<T> const& values)
{
  hsize_t const count = values.size();
  Dataspace const space(H5Screate_simple(1, &count, nullptr));
  Attribute const attribute(H5Acreate2(object, name, native<T>(), space, H5P_DEFAULT, H5P_DEFAULT));
  check(H5Awrite(attribute, native<T>(), values.data()));
}

template <class T>
void write_attribute(hid_t object, char const* name, T value)
{
  Dataspace const space(H5Screate(H5S_SCALAR));
  Attribute const attribute(H5Acreate2(object, name, native<T>(), space, H5P_DEFAULT, H5P_DEFAULT));
  check(H5Awrite(attribute, native<T>(), &value));
}

/// Changes an attribute that is there.
template <class T>
void change_attribute(hid_t object, char const* name, T value)
{
  Attribute const attribute(H5Aopen(object, name, H5P_DEFAULT));
  check(H5Awrite(attribute, native<T>(), &value));
}

template <class T>
T read_attribute(hid_t object, char const* name)
{
  T value{};
  Attribute const attribute(H5Aopen(object, name, H5P_DEFAULT));
  check(H5Aread(attribute, native<T>(), &value));
  return value;
}

/// Reads the box of the dataset that begins at `start` and is `count` large.
template <class T>
void read(hid_t dataset, Shape const& start, Shape const& count, T* values)
{
  Dataspace const space(H5Dget_space(dataset));
  Dataspace const memory(H5Screate_simple(static_cast<int>(count.size()), count.data(), nullptr));
  check(H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr));
  check(H5Dread(dataset, native<T>(), memory, space, H5P_DEFAULT, values));
}

/// Writes the box of the dataset that begins at `start` and is `count` large.
template <class T>
void write(hid_t dataset, Shape const& start, Shape const& count, T const* values)
{
  Dataspace const space(H5Dget_space(dataset));
  Dataspace const memory(H5Screate_simple(static_cast<int>(count.size()), count.data(), nullptr));
  check(H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr));
  check(H5Dwrite(dataset, native<T>(), memory, space, H5P_DEFAULT, values));
}

/// Writes a whole chunk of a dataset of this type without filters: all its values in order, which
/// go to their place in the file without any copy.
template <class T>
void write_chunk(hid_t dataset, Shape const& start, std::vector<T> const& values)
{
  check(H5Dwrite_chunk(dataset, H5P_DEFAULT, 0, start.data(), values.size() * sizeof(T),
                       values.data()));
}

/// Creates a dataset of a shape that stays.
template <class T>
Dataset create_list(hid_t parent, char const* name, Shape const& size)
{
  Dataspace const space(H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr));
  return Dataset(
      H5Dcreate2(parent, name, native<T>(), space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
}

/// Creates a dataset of these values.
template <class T>
void write_list(hid_t parent, char const* name, std::vector<T> const& values)
{
  Dataset const dataset = create_list<T>(parent, name, {values.size()});
  if (!values.empty())
    write(dataset, {0}, {values.size()}, values.data());
}

/// Reads the whole of a one-dimensional dataset.
template <class T>
std::vector<T> read_all(hid_t parent, std::string const& path)
{
  Dataset const dataset(H5Dopen2(parent, path.c_str(), H5P_DEFAULT));
  Shape const size = shape(dataset);
  if (size.size() != 1)
    throw Error("'" + path + "' is not a list");
  std::vector<T> values(size[0]);
  if (!values.empty())
    read(dataset, {0}, size, values.data());
  return values;
}

} // namespace ricochet::driver::hdf5
