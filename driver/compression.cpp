#include "compression.hpp"

#include <zlib.h>

#include <algorithm>
#include <chrono>
#include <cstring>

namespace ricochet::driver {

namespace {

using Bytes = std::vector<unsigned char>;

// A component of some discs' vectors as HDF5's filter `shuffle` leaves it: the first bytes of all
// numbers, then the second ones, and so on.
template <class Real>
Bytes shuffled(std::vector<DiscState> const& discs, std::size_t count, double DiscState::*component)
{
  Bytes bytes(count * sizeof(Real));
  for (std::size_t i = 0; i < count; ++i) {
    auto const number = static_cast<Real>(discs[i].*component);
    unsigned char raw[sizeof(Real)];
    std::memcpy(raw, &number, sizeof number);
    for (std::size_t k = 0; k < sizeof(Real); ++k)
      bytes[k * count + i] = raw[k];
  }
  return bytes;
}

template <class Real>
void deflate(TrajectoryHeader const& header, std::vector<DiscState> const& discs, std::size_t count)
{
  auto const one = [&](double DiscState::*component) {
    Bytes const bytes = shuffled<Real>(discs, count, component);
    uLongf size = ::compressBound(static_cast<uLong>(bytes.size()));
    Bytes out(size);
    ::compress2(out.data(), &size, bytes.data(), static_cast<uLong>(bytes.size()), 1);
  };
  one(&DiscState::x);
  one(&DiscState::y);
  if (!header.velocity)
    return;
  one(&DiscState::vx);
  one(&DiscState::vy);
}

} // namespace

bool is_large(TrajectoryHeader const& header)
{
  constexpr double large = 16e6; // bytes
  return forecast_bytes(header) > large;
}

double seconds_to_deflate(TrajectoryHeader const& header, std::vector<DiscState> const& discs)
{
  constexpr std::size_t enough = 20000; // discs: 160 KB of each component
  std::size_t const count = std::min(discs.size(), enough);
  if (count == 0)
    return 0;
  auto const start = std::chrono::steady_clock::now();
  if (header.float32)
    deflate<float>(header, discs, count);
  else
    deflate<double>(header, discs, count);
  std::chrono::duration<double> const spent = std::chrono::steady_clock::now() - start;
  return spent.count() * static_cast<double>(discs.size()) / static_cast<double>(count);
}

bool keeps_up(double deflating, double stepping)
{
  return 10 * deflating <= stepping;
}

} // namespace ricochet::driver
