#include "hdf5.hpp"

#include <cstdlib>

namespace ricochet::driver::hdf5 {

namespace {

std::recursive_mutex turns;

// Keeps the innermost description, and the system's own words where a call to it failed.
herr_t collect(unsigned, H5E_error2_t const* error, void* data)
{
  auto& reason = *static_cast<std::string*>(data);
  std::string const text = error->desc ? error->desc : "";
  std::string const mark = "error message = '";
  std::size_t const start = text.find(mark);
  if (start != std::string::npos) {
    std::size_t const from = start + mark.size();
    reason = text.substr(from, text.find('\'', from) - from);
  } else if (reason.empty()) {
    reason = text;
  }
  return 0;
}

Datatype text_type(std::size_t length)
{
  Datatype type(H5Tcopy(H5T_C_S1));
  check(H5Tset_size(type, length + 1));
  check(H5Tset_strpad(type, H5T_STR_NULLTERM));
  check(H5Tset_cset(type, H5T_CSET_UTF8));
  return type;
}

// Reads one text with `read`, whichever way it is stored as `type`.
template <class Read>
std::string read_stored(hid_t type, Read const& read)
{
  if (H5Tget_class(type) != H5T_STRING)
    return "";
  Datatype memory(H5Tcopy(H5T_C_S1));
  check(H5Tset_cset(memory, H5Tget_cset(type)));
  if (check(H5Tis_variable_str(type)) > 0) {
    char* text = nullptr;
    check(H5Tset_size(memory, H5T_VARIABLE));
    check(read(memory, &text));
    std::string copy = text ? text : "";
    H5free_memory(text);
    return copy;
  }
  std::string text(H5Tget_size(type) + 1, '\0');
  check(H5Tset_size(memory, text.size()));
  check(read(memory, text.data()));
  text.resize(text.find('\0')); // the memory ends with one, whatever the file has
  return text;
}

} // namespace

void throw_error()
{
  std::string reason;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, collect, &reason);
  H5Eclear2(H5E_DEFAULT);
  throw Error(reason.empty() ? "HDF5 gave no reason" : reason);
}

Turn::Turn() : lock_(turns)
{
  static bool const once = [] {
    H5dont_atexit();
    return true;
  }();
  (void)once;
  check(H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr)); // of this thread, where it has its own
}

Group create_group(hid_t parent, std::string const& path)
{
  Properties const links(H5Pcreate(H5P_LINK_CREATE));
  check(H5Pset_create_intermediate_group(links, 1));
  return Group(H5Gcreate2(parent, path.c_str(), links, H5P_DEFAULT, H5P_DEFAULT));
}

bool exists(hid_t parent, std::string const& path)
{
  // Every group on the way must exist before its member can be asked for.
  for (std::size_t slash = path.find('/', 1); slash != std::string::npos;
       slash = path.find('/', slash + 1))
    if (check(H5Lexists(parent, path.substr(0, slash).c_str(), H5P_DEFAULT)) <= 0)
      return false;
  return check(H5Lexists(parent, path.c_str(), H5P_DEFAULT)) > 0;
}

Shape shape(hid_t dataset)
{
  Dataspace const space(H5Dget_space(dataset));
  Shape size(static_cast<std::size_t>(check(H5Sget_simple_extent_ndims(space))));
  check(H5Sget_simple_extent_dims(space, size.data(), nullptr));
  return size;
}

void write_text_attribute(hid_t object, char const* name, std::string const& text)
{
  Datatype const type = text_type(text.size());
  Dataspace const space(H5Screate(H5S_SCALAR));
  Attribute const attribute(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT));
  check(H5Awrite(attribute, type, text.c_str()));
}

void write_text_attribute(hid_t object, char const* name, std::vector<std::string> const& texts)
{
  std::size_t length = 0;
  for (std::string const& text : texts)
    length = std::max(length, text.size());
  Datatype const type = text_type(length);
  std::string packed;
  for (std::string const& text : texts)
    packed += text + std::string(length + 1 - text.size(), '\0');
  hsize_t const count = texts.size();
  Dataspace const space(H5Screate_simple(1, &count, nullptr));
  Attribute const attribute(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT));
  check(H5Awrite(attribute, type, packed.data()));
}

void write_text(hid_t parent, char const* name, std::string const& text)
{
  Datatype const type = text_type(text.size());
  Dataspace const space(H5Screate(H5S_SCALAR));
  Dataset const dataset(
      H5Dcreate2(parent, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  check(H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.c_str()));
}

std::string read_text(hid_t parent, std::string const& path)
{
  if (!exists(parent, path))
    return "";
  Dataset const dataset(H5Dopen2(parent, path.c_str(), H5P_DEFAULT));
  Datatype const type(H5Dget_type(dataset));
  return read_stored(type, [&](hid_t memory, void* text) {
    return H5Dread(dataset, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, text);
  });
}

std::string read_text_attribute(hid_t parent, std::string const& path, char const* name)
{
  if (!exists(parent, path) ||
      check(H5Aexists_by_name(parent, path.c_str(), name, H5P_DEFAULT)) <= 0)
    return "";
  Attribute const attribute(H5Aopen_by_name(parent, path.c_str(), name, H5P_DEFAULT, H5P_DEFAULT));
  Datatype const type(H5Aget_type(attribute));
  return read_stored(type,
                     [&](hid_t memory, void* text) { return H5Aread(attribute, memory, text); });
}

} // namespace ricochet::driver::hdf5
