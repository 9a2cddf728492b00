// How engines make checkpoints and go on from them.
//
// Whatever holds a part of a run's books or clock has one function, visit_numbers(visit), that
// calls visit(name, number) for each of them; it serves both ways.
#pragma once

#include "ricochet/diagnostics.hpp"
#include "ricochet/engine.hpp"

#include <stdexcept>
#include <string>

namespace ricochet {

/// Enters numbers in a checkpoint.
struct SaveNumber {
  Checkpoint& checkpoint;

  void operator()(std::string const& name, std::int64_t const& value) const
  {
    checkpoint.integers[name] = value;
  }
  void operator()(std::string const& name, int const& value) const
  {
    checkpoint.integers[name] = value;
  }
  void operator()(std::string const& name, double const& value) const
  {
    checkpoint.reals[name] = value;
  }
};

/// Takes numbers from a checkpoint.
struct RestoreNumber {
  Checkpoint const& checkpoint;

  void operator()(std::string const& name, std::int64_t& value) const
  {
    value = find(checkpoint.integers, name);
  }
  void operator()(std::string const& name, int& value) const
  {
    value = static_cast<int>(find(checkpoint.integers, name));
  }
  void operator()(std::string const& name, double& value) const
  {
    value = find(checkpoint.reals, name);
  }

 private:
  template <class Number>
  static Number find(std::map<std::string, Number> const& numbers, std::string const& name)
  {
    auto const found = numbers.find(name);
    if (found == numbers.end())
      throw std::invalid_argument("the checkpoint has no " + name);
    return found->second;
  }
};

/// The checkpoint of an engine with the state `discs`, whose visit_numbers() is `visit_numbers`.
template <class Space, class Real, class VisitNumbers>
Checkpoint save(Space const& space, Discs<Space, Real> const& discs,
                VisitNumbers const& visit_numbers)
{
  Checkpoint checkpoint;
  checkpoint.discs.resize(static_cast<std::size_t>(discs.count()));
  copy_states(space, discs, checkpoint.discs.data());
  visit_numbers(SaveNumber{checkpoint});
  return checkpoint;
}

/// Puts an engine back to `checkpoint`.
template <class Space, class Real, class VisitNumbers>
void restore(Space const& space, Discs<Space, Real>& discs, VisitNumbers const& visit_numbers,
             Checkpoint const& checkpoint)
{
  if (checkpoint.discs.size() != static_cast<std::size_t>(discs.count()))
    throw std::invalid_argument("the checkpoint has " + std::to_string(checkpoint.discs.size()) +
                                " discs, the scene " + std::to_string(discs.count()));
  visit_numbers(RestoreNumber{checkpoint});
  discs = discs_from<Space, Real>(space, checkpoint.discs.data(), discs.count());
}

} // namespace ricochet
