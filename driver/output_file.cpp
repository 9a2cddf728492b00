#include "output_file.hpp"

#include "exit_codes.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
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
    fs::path const hidden = folder_of(path_) / ("." + fs::path(path_).filename().string());
    temporary_ = fmt::format("{}.{}.tmp", hidden.string(), ::getpid());
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
  bool const closed = std::fclose(std::exchange(file_, nullptr)) == 0;
  bool const placed =
      closed && (temporary_.empty() || std::rename(temporary_.c_str(), path_.c_str()) == 0);
  if (!placed) {
    int const reason = errno;
    if (!temporary_.empty())
      ::unlink(temporary_.c_str());
    errno = reason;
    fail();
  }
}

void OutputFile::fail() const
{
  throw Failure(Exit::io_error, fmt::format("cannot write {}: {}",
                                            path_ == "-" ? "to standard output" : "'" + path_ + "'",
                                            std::strerror(errno)));
}

} // namespace ricochet::driver
