#include "output_file.hpp"

#include "exit_codes.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace ricochet::driver {

namespace fs = std::filesystem;

namespace {

fs::path folder_of(fs::path const& path)
{
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

// A terminal, a pipe or /dev/null: written to as it is, and nothing is lost by that.
bool is_special(fs::path const& path)
{
  std::error_code ignored;
  auto const status = fs::status(path, ignored);
  return fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status);
}

} // namespace

void check_output(std::string const& path, bool replace)
{
  auto const refuse = [&](std::string const& why) {
    throw Failure(Exit::cannot_create, fmt::format("cannot create '{}': {}", path, why));
  };
  if (is_special(path))
    return;
  std::error_code ignored;
  if (fs::is_directory(path, ignored))
    refuse("it is a directory");
  if (fs::exists(fs::symlink_status(path, ignored)) && !replace)
    refuse("it exists already (--force replaces it)");
  std::string const folder = folder_of(path).string();
  if (!fs::is_directory(folder, ignored))
    refuse(fmt::format("there is no folder '{}'", folder));
  if (::access(folder.c_str(), W_OK | X_OK) != 0)
    refuse(fmt::format("folder '{}': {}", folder, std::strerror(errno)));
}

bool same_file(std::string const& a, std::string const& b)
{
  std::error_code error;
  if (fs::equivalent(a, b, error) && !error)
    return true;
  auto const resolved = [](std::string const& path) {
    std::error_code ignored;
    auto const folder = fs::weakly_canonical(folder_of(path), ignored);
    return folder / fs::path(path).filename();
  };
  return resolved(a) == resolved(b);
}

void check_outputs(std::vector<std::string> const& outputs, std::vector<std::string> const& inputs,
                   bool replace)
{
  std::vector<std::string> checked;
  for (std::string const& output : outputs) {
    if (output.empty() || output == "-")
      continue;
    for (std::string const& input : inputs)
      if (!input.empty() && same_file(output, input))
        throw Failure(Exit::cannot_create,
                      fmt::format("cannot create '{}': it is an input", output));
    for (std::string const& other : checked)
      if (same_file(output, other))
        throw Failure(Exit::usage, fmt::format("'{}' is named for two outputs", output));
    check_output(output, replace);
    checked.push_back(output);
  }
}

bool is_file_output(std::string const& path)
{
  return !path.empty() && path != "-" && !is_special(path);
}

std::string hidden_beside(std::string const& path, std::string const& ending)
{
  fs::path const name = "." + fs::path(path).filename().string() + "." + ending;
  return (fs::path(path).has_parent_path() ? fs::path(path).parent_path() / name : name).string();
}

void sync_to_disk(std::string const& path)
{
  int const file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  // File systems that have nothing to write say that they cannot.
  bool const done = file >= 0 && (::fsync(file) == 0 || errno == EINVAL || errno == EROFS);
  int const reason = errno;
  if (file >= 0)
    ::close(file);
  if (!done)
    throw std::system_error(reason, std::generic_category());
}

void put_in_place(std::string const& temporary, std::string const& path)
{
  sync_to_disk(temporary);
  if (std::rename(temporary.c_str(), path.c_str()) != 0)
    throw std::system_error(errno, std::generic_category());
  sync_to_disk(folder_of(path).string());
}

OutputFile::OutputFile(std::string path, bool replace) : path_(std::move(path))
{
  if (path_ == "-") {
    file_ = stdout;
    return;
  }
  check_output(path_, replace);
  if (!is_special(path_)) {
    std::error_code error;
    auto const target = fs::canonical(path_, error); // a link keeps pointing to the new content
    if (!error)
      path_ = target.string();
    temporary_ = hidden_beside(path_, fmt::format("{}.tmp", ::getpid()));
  }
  errno = 0;
  file_ = std::fopen(temporary_.empty() ? path_.c_str() : temporary_.c_str(), "wb");
  if (!file_)
    throw Failure(Exit::cannot_create,
                  fmt::format("cannot create '{}': {}", path_, std::strerror(errno)));
}

OutputFile::~OutputFile()
{
  if (file_ && file_ != stdout) {
    std::fclose(file_);
    if (!temporary_.empty())
      ::unlink(temporary_.c_str());
  }
}

void OutputFile::write(std::string_view text)
{
  errno = 0;
  if (std::fwrite(text.data(), 1, text.size(), file_) != text.size())
    fail();
}

void OutputFile::commit()
{
  errno = 0;
  if (std::fflush(file_) != 0)
    fail();
  if (file_ == stdout) {
    file_ = nullptr;
    return;
  }
  int reason = std::fclose(std::exchange(file_, nullptr)) == 0 ? 0 : errno;
  if (temporary_.empty() && reason == 0)
    return;
  try {
    if (reason == 0)
      return put_in_place(temporary_, path_);
  } catch (std::system_error const& error) {
    reason = error.code().value();
  }
  if (!temporary_.empty())
    ::unlink(temporary_.c_str());
  errno = reason;
  fail();
}

void OutputFile::fail() const
{
  throw Failure(Exit::io_error, fmt::format("cannot write {}: {}",
                                            path_ == "-" ? "to standard output" : "'" + path_ + "'",
                                            std::strerror(errno)));
}

} // namespace ricochet::driver
