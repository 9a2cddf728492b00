// Reading a file from beginning to end, with failures that name it.
#pragma once

#include <cstddef>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>

namespace ricochet::driver {

/// An input file open for reading.
class InputFile {
 public:
  /// Throws Failure(Exit::no_input) if `path` cannot be opened or is a directory.
  explicit InputFile(std::string const& path);

  /// Reads up to `size` bytes; less only at the end. Throws Failure(Exit::io_error).
  std::size_t read(char* buffer, std::size_t size);

  /// Length of the file, 0 if it has none (a pipe).
  std::size_t size() const;

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::string path_;
  std::unique_ptr<std::FILE, Close> file_;
};

/// The whole of the file `path`, or nothing if it is longer than `longest` bytes. Throws Failure.
std::optional<std::string> read_text(std::string const& path, std::size_t longest);

} // namespace ricochet::driver
