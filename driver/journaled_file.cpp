#include "journaled_file.hpp"

#include "output_file.hpp"

#include <zlib.h>

#if H5_VERSION_GE(1, 13, 0)
#include <H5FDdevelop.h>
#endif

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fcntl.h>
#include <iterator>
#include <map>
#include <memory>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

namespace ricochet::driver {

namespace {

constexpr std::uint64_t page_size = 4096;
constexpr std::uint64_t writeback_step = 8 << 20;
using Page = std::array<char, page_size>;
using Pages = std::map<std::uint64_t, std::unique_ptr<Page>>; ///< by their number in the file

std::string journal_of(std::string const& path)
{
  return hidden_beside(path, "journal");
}

[[noreturn]] void throw_errno()
{
  throw std::system_error(errno, std::generic_category());
}

void write_at(int file, std::uint64_t at, char const* data, std::size_t size)
{
  while (size > 0) {
    ssize_t const done = ::pwrite(file, data, size, static_cast<off_t>(at));
    if (done < 0 && errno != EINTR)
      throw_errno();
    std::size_t const moved = done < 0 ? 0 : static_cast<std::size_t>(done);
    at += moved, data += moved, size -= moved;
  }
}

// Beyond the end of the file there are zeros.
void read_at(int file, std::uint64_t at, char* data, std::size_t size)
{
  while (size > 0) {
    ssize_t const done = ::pread(file, data, size, static_cast<off_t>(at));
    if (done < 0 && errno != EINTR)
      throw_errno();
    if (done == 0)
      std::memset(data, 0, size);
    std::size_t const moved = done < 0 ? 0 : done == 0 ? size : static_cast<std::size_t>(done);
    at += moved, data += moved, size -= moved;
  }
}

void set_size(int file, std::uint64_t size)
{
  if (::ftruncate(file, static_cast<off_t>(size)) != 0)
    throw_errno();
}

std::uint64_t size_of(int file)
{
  struct stat status {};
  if (::fstat(file, &status) != 0)
    throw_errno();
  return static_cast<std::uint64_t>(status.st_size);
}

// Has the disk begin to write a range. Left to the system it would begin half a minute later, and
// stand idle meanwhile.
void begin_writeback(int file, std::uint64_t from, std::uint64_t to)
{
#ifdef __linux__
  // It is advice: what fails shows when the file is synced.
  ::sync_file_range(file, static_cast<off_t>(from), static_cast<off_t>(to - from),
                    SYNC_FILE_RANGE_WRITE);
#else
  (void)file, (void)from, (void)to;
#endif
}

/// What a flush changes: pages, and the size of the file.
struct Change {
  Pages pages;
  std::uint64_t size = 0;

  /// Makes the change in the file. It may be made again.
  void apply(int file) const
  {
    if (size_of(file) != size) // for it gives back what room was reserved
      set_size(file, size);
    for (auto const& [number, page] : pages)
      if (std::uint64_t const at = number * page_size; at < size)
        write_at(file, at, page->data(), std::min(page_size, size - at));
  }
};

/// The journal begins with this; then come the numbers of the pages, then the pages.
struct JournalHead {
  static constexpr std::uint64_t valid = 0x6c616e72756f6a2e;
  std::uint64_t mark = 0; ///< `valid` while the change is not known to be in the file
  std::uint64_t pages = 0, size = 0, checksum = 0;
};

std::uint64_t checksum_of(JournalHead const& head, std::string const& body)
{
  unsigned long sum = ::crc32_z(0, nullptr, 0);
  for (std::uint64_t const number : {head.pages, head.size})
    sum = ::crc32_z(sum, reinterpret_cast<unsigned char const*>(&number), sizeof number);
  return ::crc32_z(sum, reinterpret_cast<unsigned char const*>(body.data()), body.size());
}

void write_journal(int journal, Change const& change)
{
  std::string body;
  for (auto const& [number, page] : change.pages)
    body.append(reinterpret_cast<char const*>(&number), sizeof number);
  for (auto const& [number, page] : change.pages)
    body.append(page->data(), page_size);
  JournalHead head{JournalHead::valid, change.pages.size(), change.size, 0};
  head.checksum = checksum_of(head, body);
  write_at(journal, sizeof head, body.data(), body.size());
  write_at(journal, 0, reinterpret_cast<char const*>(&head), sizeof head);
}

void clear_journal(int journal)
{
  JournalHead const none;
  write_at(journal, 0, reinterpret_cast<char const*>(&none), sizeof none);
}

// The change in a journal; one of nothing, and false, if it is not complete or done with.
bool read_journal(std::string const& path, Change& change)
{
  int const journal = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (journal < 0)
    return false;
  JournalHead head;
  read_at(journal, 0, reinterpret_cast<char*>(&head), sizeof head);
  std::uint64_t const bytes = head.pages * (sizeof(std::uint64_t) + page_size);
  bool const is_whole = head.mark == JournalHead::valid && sizeof head + bytes <= size_of(journal);
  std::string body(is_whole ? bytes : 0, '\0');
  read_at(journal, sizeof head, body.data(), body.size());
  ::close(journal);
  if (!is_whole || checksum_of(head, body) != head.checksum)
    return false;
  change.size = head.size;
  char const* const data = body.data() + head.pages * sizeof(std::uint64_t);
  for (std::uint64_t k = 0; k < head.pages; ++k) {
    std::uint64_t number = 0;
    std::memcpy(&number, body.data() + k * sizeof number, sizeof number);
    auto page = std::make_unique<Page>();
    std::memcpy(page->data(), data + k * page_size, page_size);
    change.pages[number] = std::move(page);
  }
  return true;
}

/// An open file. HDF5 knows it by its first member.
struct JournaledFile {
  H5FD_t base{};
  std::string path;
  int file = -1, journal = -1;
  bool is_writable = false;
  haddr_t end_of_addresses = 0;
  std::uint64_t old_pages = 0; ///< that the last flush left; they change in `change` only
  std::uint64_t to_disk = 0;   ///< up to here the disk was told to write
  Change change;

  JournaledFile(char const* name, bool create, bool writable) : path(name), is_writable(writable)
  {
    int const flags = (writable ? O_RDWR : O_RDONLY) | (create ? O_CREAT | O_TRUNC : 0);
    file = ::open(name, flags | O_CLOEXEC, 0666);
    if (file < 0)
      throw_errno();
    change.size = size_of(file);
    if (read_journal(journal_of(path), change) && writable)
      change.apply(file);
    if (writable) {
      change.pages.clear();
      ::unlink(journal_of(path).c_str());
    }
    old_pages = (change.size + page_size - 1) / page_size;
    to_disk = change.size;
  }
  JournaledFile(JournaledFile const&) = delete;
  JournaledFile& operator=(JournaledFile const&) = delete;
  ~JournaledFile()
  {
    if (journal >= 0) {
      ::unlink(journal_of(path).c_str());
      ::close(journal);
    }
    if (file >= 0)
      ::close(file);
  }

  /// Calls part(page, offset in it, offset in the buffer, bytes) for all pages of a range.
  template <class Part>
  static void for_pages(std::uint64_t at, std::size_t size, Part const& part)
  {
    for (std::size_t done = 0; done < size;) {
      std::uint64_t const page = (at + done) / page_size, offset = (at + done) % page_size;
      std::size_t const bytes = std::min<std::size_t>(page_size - offset, size - done);
      part(page, offset, done, bytes);
      done += bytes;
    }
  }

  void read(std::uint64_t at, std::size_t size, char* data) const
  {
    read_at(file, at, data, size);
    if (change.pages.empty())
      return;
    for_pages(at, size, [&](std::uint64_t page, std::uint64_t offset, std::size_t to, auto bytes) {
      auto const found = change.pages.find(page);
      if (found != change.pages.end())
        std::memcpy(data + to, found->second->data() + offset, bytes);
    });
  }

  void write(std::uint64_t at, std::size_t size, char const* data)
  {
    std::uint64_t const new_from = old_pages * page_size;
    std::size_t const old = at >= new_from ? 0 : std::min<std::uint64_t>(size, new_from - at);
    for_pages(at, old,
              [&](std::uint64_t number, std::uint64_t offset, std::size_t from, auto bytes) {
                auto& page = change.pages[number];
                if (!page) {
                  page = std::make_unique<Page>();
                  if (bytes < page_size)
                    read_at(file, number * page_size, page->data(), page_size);
                }
                std::memcpy(page->data() + offset, data + from, bytes);
              });
    // The file as it was knows nothing of what is behind its end.
    write_at(file, at + old, data + old, size - old);
    if (at + size >= to_disk + writeback_step) {
      begin_writeback(file, to_disk, at + size);
      to_disk = at + size;
    }
  }

  void flush()
  {
    if (!is_writable || (change.pages.empty() && change.size == size_of(file)))
      return;
    if (journal < 0) {
      journal = ::open(journal_of(path).c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
      if (journal < 0)
        throw_errno();
    }
    write_journal(journal, change);
    change.apply(file);
    clear_journal(journal);
    change.pages.clear();
    old_pages = (change.size + page_size - 1) / page_size;
    to_disk = std::min(to_disk, change.size); // frames that were cut off are written anew
  }
};

JournaledFile& of(H5FD_t* file)
{
  return *reinterpret_cast<JournaledFile*>(file);
}

JournaledFile const& of(H5FD_t const* file)
{
  return *reinterpret_cast<JournaledFile const*>(file);
}

// Does `work`; tells HDF5, in its own way, why it failed.
template <class Work>
herr_t told(Work const& work)
{
  std::string reason;
  try {
    work();
    return 0;
  } catch (std::system_error const& error) {
    reason = error.code().message();
  } catch (std::exception const& error) {
    reason = error.what();
  }
  H5Epush2(H5E_DEFAULT, __FILE__, __func__, __LINE__, H5E_ERR_CLS, H5E_IO, H5E_CANTOPERATE,
           "error message = '%s'", reason.c_str());
  return -1;
}

H5FD_t* open_file(char const* name, unsigned flags, hid_t, haddr_t)
{
  JournaledFile* opened = nullptr;
  told([&] {
    opened = new JournaledFile(name, (flags & H5F_ACC_TRUNC) != 0, (flags & H5F_ACC_RDWR) != 0);
  });
  return opened ? &opened->base : nullptr;
}

herr_t close_file(H5FD_t* file)
{
  return told([&] {
    std::unique_ptr<JournaledFile> const closing(&of(file));
    closing->flush();
  });
}

herr_t query(H5FD_t const*, unsigned long* flags)
{
  if (flags) // those of HDF5's own driver for files
    *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
             H5FD_FEAT_AGGREGATE_SMALLDATA | H5FD_FEAT_DEFAULT_VFD_COMPATIBLE;
  return 0;
}

haddr_t end_of_addresses(H5FD_t const* file, H5FD_mem_t)
{
  return of(file).end_of_addresses;
}

herr_t set_end_of_addresses(H5FD_t* file, H5FD_mem_t, haddr_t address)
{
  of(file).end_of_addresses = address;
  return 0;
}

haddr_t end_of_file(H5FD_t const* file, H5FD_mem_t)
{
  haddr_t end = HADDR_UNDEF;
  told([&] { end = std::max<haddr_t>(of(file).change.size, size_of(of(file).file)); });
  return end;
}

herr_t read(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t at, size_t size, void* data)
{
  return told([&] { of(file).read(at, size, static_cast<char*>(data)); });
}

herr_t write(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t at, size_t size, void const* data)
{
  return told([&] { of(file).write(at, size, static_cast<char const*>(data)); });
}

herr_t flush(H5FD_t* file, hid_t, hbool_t)
{
  return told([&] { of(file).flush(); });
}

// HDF5 asks for this before it flushes; it is part of the change.
herr_t truncate(H5FD_t* file, hid_t, hbool_t)
{
  of(file).change.size = of(file).end_of_addresses;
  return 0;
}

hid_t driver()
{
  static hid_t const registered = [] {
    static H5FD_class_t type{};
#if H5_VERSION_GE(1, 13, 0)
    type.version = H5FD_CLASS_VERSION;
    type.value = static_cast<H5FD_class_value_t>(512); // the numbers from 512 on are for tests
#endif
    type.name = "journaled";
    type.maxaddr = HADDR_MAX;
    type.fc_degree = H5F_CLOSE_WEAK;
    type.open = open_file;
    type.close = close_file;
    type.query = query;
    type.get_eoa = end_of_addresses;
    type.set_eoa = set_end_of_addresses;
    type.get_eof = end_of_file;
    type.read = read;
    type.write = write;
    type.flush = flush;
    type.truncate = truncate;
    H5FD_mem_t const map[] = H5FD_FLMAP_DICHOTOMY;
    std::copy(std::begin(map), std::end(map), type.fl_map);
    return H5FDregister(&type);
  }();
  return hdf5::check(registered);
}

} // namespace

void set_journaled(hdf5::Properties const& access)
{
  hdf5::check(H5Pset_driver(access, driver(), nullptr));
}

void forget_journal(std::string const& path)
{
  ::unlink(journal_of(path).c_str());
}

void tidy_journal(std::string const& path)
{
  Change change;
  if (!read_journal(journal_of(path), change))
    forget_journal(path);
}

} // namespace ricochet::driver
