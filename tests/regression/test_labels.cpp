// Every kernel, allocation and region of a run carries a label that begins with `ricochet::`, so
// that Kokkos Tools shows the physics; and the host seldom waits for what the device has counted.
// The tests listen to runs as a tool does.
#include "support/runs.hpp"

#include <Kokkos_Core.hpp>
#include <gtest/gtest.h>

#include <map>
#include <set>

namespace ricochet::test {
namespace {

/// What the run told the tool, by kind.
struct Heard {
  std::set<std::string> kernels, allocations, regions;
  std::map<std::string, int> launches, reads; ///< of kernels, and of single values by the host
};
Heard heard;

void on_kernel(char const* label, std::uint32_t, std::uint64_t*)
{
  heard.kernels.insert(label);
  ++heard.launches[label];
}

void on_copy(Kokkos::Tools::SpaceHandle, char const* to, void const*, Kokkos::Tools::SpaceHandle,
             char const* from, void const*, std::uint64_t)
{
  if (std::string(to) == "Scalar")
    ++heard.reads[from];
}

void on_allocation(Kokkos::Tools::SpaceHandle, char const* label, void const*, std::uint64_t)
{
  heard.allocations.insert(label);
}

void on_region(char const* label)
{
  heard.regions.insert(label);
}

/// Listens while it lives.
class Listening {
 public:
  Listening() : before_(Kokkos::Tools::Experimental::get_callbacks())
  {
    namespace tools = Kokkos::Tools::Experimental;
    heard = {};
    tools::set_begin_parallel_for_callback(on_kernel);
    tools::set_begin_parallel_reduce_callback(on_kernel);
    tools::set_begin_parallel_scan_callback(on_kernel);
    tools::set_allocate_data_callback(on_allocation);
    tools::set_push_region_callback(on_region);
    tools::set_begin_deep_copy_callback(on_copy);
  }
  ~Listening() { Kokkos::Tools::Experimental::set_callbacks(before_); }
  Listening(Listening const&) = delete;
  Listening& operator=(Listening const&) = delete;

 private:
  Kokkos::Tools::Experimental::EventSet before_;
};

bool begins_with(std::string const& text, std::string const& start)
{
  return text.compare(0, start.size(), start) == 0;
}

/// Ours, or what Kokkos itself launches to fill a View of ours ("... [ricochet::x]"), or a service
/// of Kokkos that a user cannot label: a copy, or its own scratch, which is "[unlabeled]" in 3.4 (a
/// View without a label is "").
bool is_labelled(std::string const& label)
{
  if (label == "[unlabeled]")
    return true;
  if (begins_with(label, "ricochet::"))
    return true;
  auto const view = label.find('[');
  if (begins_with(label, "Kokkos::") && view != std::string::npos)
    return begins_with(label.substr(view + 1), "ricochet::");
  return begins_with(label, "Kokkos::");
}

std::size_t count_ours(std::set<std::string> const& labels)
{
  std::size_t count = 0;
  for (auto const& label : labels)
    count += begins_with(label, "ricochet::") ? 1 : 0;
  return count;
}

/// Every part of the interface once.
void use(Scene const& scene, Way const& way)
{
  auto const engine = start(scene, way);
  engine->advance(3);
  engine->report();
  states(engine);
  engine->state_hash();
}

class Labels : public testing::TestWithParam<Way> {};

TEST_P(Labels, NameThePhysicsOfARun)
{
  Listening const listening;
  for (auto const boundary : {Boundary::walls, Boundary::periodic}) {
    Scene scene;
    scene.model = make_model(30, 30, boundary == Boundary::walls ? 9.81 : 0,
                             {Law::restitution, 0.9, 0.9}, boundary, boundary);
    bool const overlaps =
        GetParam().engine == EngineKind::sweep || GetParam().engine == EngineKind::simultaneous;
    scene.discs = overlaps ? random_discs(scene.model, 100, 10, Ids::shuffled, 1)
                           : separate_discs(scene.model, 100, 10, 1);
    use(scene, GetParam());
  }

  for (auto const* labels : {&heard.kernels, &heard.allocations, &heard.regions}) {
    EXPECT_GT(count_ours(*labels), 0u) << "a run with nothing to hear proves nothing";
    for (auto const& label : *labels)
      EXPECT_TRUE(is_labelled(label)) << "label \"" << label << "\"";
  }
}

// The ear itself: what has no label of ours must be heard as such.
TEST(Labels, AreMissedWhereTheyAreMissing)
{
  Listening const listening;
  Kokkos::kokkos_free(Kokkos::kokkos_malloc("nameless", 8));
  EXPECT_EQ(heard.allocations.count("nameless"), 1u);
  EXPECT_FALSE(is_labelled("nameless"));
  EXPECT_FALSE(is_labelled(""));
  EXPECT_FALSE(is_labelled("Kokkos::View::initialization [nameless]"));
  EXPECT_TRUE(is_labelled("Kokkos::View::initialization [ricochet::x]"));
}

// `toi` reads what was counted at the end of a step, and before that only where a step takes more
// rounds than the one before, or a disc has become the fastest.
TEST(Waiting, OfTheHostForRoundsIsRare)
{
  constexpr int steps = 50;
  Scene scene;
  scene.model =
      make_model(112, 112, 0, {Law::restitution, 1, 1}, Boundary::periodic, Boundary::periodic);
  scene.discs = separate_discs(scene.model, 2000, 10, 1);
  scene.dt = 0.02;
  for (auto const& way : ways_of(EngineKind::toi)) {
    SCOPED_TRACE(name(way));
    auto const engine = start(scene, way);
    engine->advance(steps);
    Listening const listening;
    engine->advance(steps);
    int const rounds = heard.launches["ricochet::choose_next"];
    int const reads = heard.reads["ricochet::called_in_rounds"];
    EXPECT_GT(rounds, 5 * steps) << "few rounds prove nothing";
    EXPECT_GE(reads, steps) << "not all was heard";
    EXPECT_LT(reads, rounds / 2);
  }
}

INSTANTIATE_TEST_SUITE_P(
    OfSeparateDiscs, Labels,
    testing::Values(Way{EngineKind::toi, Precision::double_, Placement::serial},
                    Way{EngineKind::toi, Precision::double_, Placement::parallel},
                    Way{EngineKind::events, Precision::double_, Placement::serial},
                    Way{EngineKind::events, Precision::double_, Placement::parallel}),
    [](auto const& way) { return name(way.param); });
INSTANTIATE_TEST_SUITE_P(Ways, Labels, testing::ValuesIn(all_ways()),
                         [](auto const& way) { return name(way.param); });

} // namespace
} // namespace ricochet::test
