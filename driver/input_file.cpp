#include "input_file.hpp"

#include "exit_codes.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

namespace ricochet::driver {

InputFile::InputFile(std::string const& path) : path_(path)
{
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored))
    throw Failure(Exit::no_input, fmt::format("cannot read '{}': it is a directory", path));
  errno = 0;
  file_.reset(std::fopen(path.c_str(), "rb"));
  if (!file_)
    throw Failure(Exit::no_input, fmt::format("cannot read '{}': {}", path, std::strerror(errno)));
}

std::size_t InputFile::read(char* buffer, std::size_t size)
{
  std::size_t const got = std::fread(buffer, 1, size, file_.get());
  if (std::ferror(file_.get()))
    throw Failure(Exit::io_error,
                  fmt::format("cannot read '{}' further: {}", path_, std::strerror(errno)));
  return got;
}

std::size_t InputFile::size() const
{
  std::error_code error;
  auto const bytes = std::filesystem::file_size(path_, error);
  return error ? 0 : static_cast<std::size_t>(bytes);
}

std::optional<std::string> read_text(std::string const& path, std::size_t longest)
{
  std::string text(longest + 1, '\0');
  text.resize(InputFile(path).read(text.data(), text.size()));
  if (text.size() > longest)
    return std::nullopt;
  return text;
}

} // namespace ricochet::driver
