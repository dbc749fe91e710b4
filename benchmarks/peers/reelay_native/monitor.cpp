// reelay's own C++ monitor, discrete time, without Python.
//
//   monitor memory|csv FILE PATTERN...
//
// A row is one byte: bit i is the column of the letter LETTERS[i]; a column is named `v_` and that
// letter. `memory` reads the whole FILE (bytes), then times only the monitors' loop, and prints CPU ns
// and the first violated row per pattern. `csv` (a header, then `t,0,1,…`) judges while it reads, like a
// program that is called once.
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "cudd/cudd.hpp"
#include "reelay/datafield.hpp"

static const char LETTERS[] = "pqrs";

struct Row {
  std::uint8_t bits;
};

namespace reelay {
template <>
struct datafield<Row> {
  static bool contains(const Row &, const std::string &) { return true; }
  static bool as_bool(const Row &row, const std::string &key) {
    // 'p' to 's' follow each other: the letter gives the bit without a search.
    return (row.bits >> (key.back() - 'p')) & 1;
  }
  static int as_integer(const Row &row, const std::string &key) { return as_bool(row, key); }
  static double as_floating(const Row &row, const std::string &key) { return as_bool(row, key); }
  static std::string as_string(const Row &, const std::string &) { return std::string(); }
  static bool contains(const Row &, std::size_t) { return false; }
  static bool as_bool(const Row &, std::size_t) { return false; }
  static int as_integer(const Row &, std::size_t) { return 0; }
  static double as_floating(const Row &, std::size_t) { return 0; }
  static std::string as_string(const Row &, std::size_t) { return std::string(); }
};
}  // namespace reelay

#include "reelay/networks/discrete_timed_network.hpp"

using network = reelay::discrete_timed_network<std::int64_t, Row>;

struct Judge {
  std::vector<std::shared_ptr<network>> networks;
  std::vector<std::int64_t> violated;
  std::int64_t row = 0;

  explicit Judge(const std::vector<std::string> &patterns) : violated(patterns.size(), -1) {
    for (const auto &pattern : patterns) networks.push_back(network::make_shared(pattern));
  }
  void take(Row now) {
    for (std::size_t k = 0; k < networks.size(); ++k)
      if (!networks[k]->update(now) && violated[k] < 0) violated[k] = row;
    ++row;
  }
  void print(std::int64_t cpu_ns) const {
    std::printf("%lld", static_cast<long long>(cpu_ns));
    for (auto first : violated) std::printf(" %lld", static_cast<long long>(first));
    std::printf("\n");
  }
};

static std::int64_t cpu_ns() {
  timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return now.tv_sec * 1000000000LL + now.tv_nsec;
}

static int memory(const char *path, const std::vector<std::string> &patterns) {
  std::ifstream file(path, std::ios::binary);
  std::vector<char> rows((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  Judge judge(patterns);
  auto began = cpu_ns();
  for (char bits : rows) judge.take(Row{static_cast<std::uint8_t>(bits)});
  judge.print(cpu_ns() - began);
  return 0;
}

static int stream(const char *path, const std::vector<std::string> &patterns) {
  std::FILE *file = std::fopen(path, "rb");
  if (!file) return 2;
  Judge judge(patterns);
  static char block[1 << 16];
  int columns[16], count = -1, column = 0;  // -1: the name of the time column
  bool header = true;
  std::uint8_t bits = 0;
  for (std::size_t got; (got = std::fread(block, 1, sizeof block, file)) > 0;) {
    for (std::size_t i = 0; i < got; ++i) {
      char c = block[i];
      if (header) {
        if ((c == ',' || c == '\n')) ++count;
        else if (count >= 0 && count < 16) columns[count] = c - 'p';  // the last letter of a name
        if (c == '\n') header = false;
      } else if (c == '\n') {
        judge.take(Row{bits});
        bits = 0;
        column = 0;
      } else if (c == ',') {
        ++column;
      } else if (column > 0 && c == '1') {
        bits |= 1u << columns[column - 1];
      }
    }
  }
  std::fclose(file);
  judge.print(0);
  return 0;
}

int main(int argc, char **argv) {
  if (argc < 4) return 2;
  std::vector<std::string> patterns(argv + 3, argv + argc);
  return std::strcmp(argv[1], "memory") ? stream(argv[2], patterns) : memory(argv[2], patterns);
}
