// Writing a result so that it is there whole or not at all, and never in place of another file
// unasked.
#pragma once

#include <cstdio>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace ricochet::driver {

/// Throws Failure(Exit::cannot_create) unless a file can be made at `path`: its folder exists and
/// can be written to, and nothing stands there already, unless `replace`.
void check_output(std::string const& path, bool replace);

/// True if both paths lead to the same file.
bool same_file(std::string const& a, std::string const& b);

/// Throws Failure if any of `outputs` cannot be made in the sense of check_output(), stands in
/// place of one of `inputs`, or is named twice. Empty paths, and "-" among the outputs, mean no
/// file.
void check_outputs(std::vector<std::string> const& outputs, std::vector<std::string> const& inputs,
                   bool replace);

/// True if an output at `path` is a file: not "", "-" or a special file such as /dev/null.
bool is_file_output(std::string const& path);

/// A name in the folder of `path` for what belongs to it and is not for users: .NAME.`ending`.
std::string hidden_beside(std::string const& path, std::string const& ending);

/// Has everything of the file at `path` written to the disk. Throws std::system_error.
void sync_to_disk(std::string const& path);

/// Renames a complete file so that `path` is the old file or the new one, and whole, even if the
/// machine stops. Throws std::system_error.
void put_in_place(std::string const& temporary, std::string const& path);

/// A text result on its way to a file, or to standard output if the path is "-".
class OutputFile {
 public:
  /// Throws Failure(Exit::cannot_create).
  OutputFile(std::string path, bool replace);
  ~OutputFile(); ///< without commit(), nothing is left behind
  OutputFile(OutputFile const&) = delete;
  OutputFile& operator=(OutputFile const&) = delete;

  /// Throws Failure(Exit::io_error).
  void write(std::string_view text);

  /// Where the file is until then, for another program to write it.
  std::string const& place() const { return temporary_.empty() ? path_ : temporary_; }

  /// Puts the file in its place. Throws Failure.
  void commit();

 private:
  [[noreturn]] void fail() const;

  std::string path_;
  std::string temporary_; ///< where the text goes until commit(); empty if straight to path_
  std::FILE* file_ = nullptr;
};

} // namespace ricochet::driver
