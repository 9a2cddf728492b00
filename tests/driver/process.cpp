#include "process.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace ricochet::test {

namespace fs = std::filesystem;

Folder::Folder()
{
  std::string name = (fs::temp_directory_path() / "ricochet-test-XXXXXX").string();
  if (!::mkdtemp(name.data()))
    throw std::runtime_error("no temporary folder");
  path_ = name;
}

Folder::~Folder()
{
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

std::string Folder::write(std::string const& name, std::string const& text) const
{
  std::string path = *this / name;
  std::ofstream(path, std::ios::binary) << text;
  return path;
}

std::vector<std::string> Folder::names() const
{
  std::vector<std::string> names;
  for (auto const& entry : fs::directory_iterator(path_))
    names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

std::string text_of(std::string const& path)
{
  std::ifstream file(path, std::ios::binary);
  EXPECT_TRUE(file) << "cannot read " << path;
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

std::string scene(std::string const& name)
{
  return std::string(RICOCHET_SCENES) + "/" + name;
}

std::string slurm(std::string const& name)
{
  return std::string(RICOCHET_SLURM) + "/" + name;
}

std::string program()
{
  return RICOCHET_PROGRAM;
}

Outcome ricochet(std::vector<std::string> const& arguments, ProcessOptions const& options)
{
  return Process(arguments, options).wait();
}

Process::Process(std::vector<std::string> const& arguments, ProcessOptions const& options)
  : out_(options.standard_output.empty() ? folder_ / "out" : options.standard_output)
{
  // Everything is made ready before fork(): afterwards, in a program with threads, little is
  // allowed.
  std::string const err = folder_ / "err";
  std::vector<std::string> words{options.other_program.empty() ? program() : options.other_program};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words)
    argv.push_back(word.data());
  argv.push_back(nullptr);
  std::vector<std::string> variables = options.environment;
  std::vector<char*> environment;
  for (std::string& variable : variables)
    environment.push_back(variable.data());
  for (char** variable = environ; *variable; ++variable) {
    std::string const present = *variable, name = present.substr(0, present.find('=') + 1);
    if (std::none_of(variables.begin(), variables.end(),
                     [&](std::string const& other) { return other.rfind(name, 0) == 0; }))
      environment.push_back(*variable);
  }
  environment.push_back(nullptr);

  id_ = ::fork();
  if (id_ < 0)
    throw std::runtime_error("cannot fork");
  if (id_ > 0)
    return;
  int const in_file = ::open("/dev/null", O_RDONLY);
  int const out_file = ::open(out_.c_str(), O_WRONLY | O_CREAT, 0600);
  int const err_file = ::open(err.c_str(), O_WRONLY | O_CREAT, 0600);
  ::dup2(in_file, 0);
  ::dup2(out_file, 1);
  ::dup2(err_file, 2);
  if (options.file_size_limit >= 0) {
    rlimit const limit{static_cast<rlim_t>(options.file_size_limit), RLIM_INFINITY};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ::execve(argv[0], argv.data(), environment.data());
  ::_exit(127);
}

Process::~Process()
{
  if (!ended_) {
    ::kill(id_, SIGKILL);
    int status = 0;
    ::waitpid(id_, &status, 0);
  }
}

void Process::note(int status)
{
  ended_ = true;
  code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

bool Process::is_running()
{
  int status = 0;
  if (!ended_ && ::waitpid(id_, &status, WNOHANG) == id_)
    note(status);
  return !ended_;
}

void Process::kill()
{
  send(SIGKILL);
}

void Process::send(int signal)
{
  if (!ended_)
    ::kill(id_, signal);
}

Outcome Process::wait()
{
  int status = 0;
  if (!ended_ && ::waitpid(id_, &status, 0) == id_)
    note(status);
  bool const readable = out_ == folder_ / "out";
  return {code_, readable ? text_of(out_) : "", text_of(folder_ / "err")};
}

} // namespace ricochet::test
