#include "tests/support/net/server_process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sched.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <regex>
#include <thread>

#include "protocol/login/login_token.hpp"
#include "protocol/units/operator_error.hpp"

namespace trochoid {

namespace {

using std::filesystem::path;

constexpr auto start_patience = std::chrono::seconds(120);

/// In the folder of our own program, or in bin beside it.
path server_program() {
    const path here = std::filesystem::read_symlink("/proc/self/exe").parent_path();
    for (const path& folder : {here, here.parent_path() / "bin"})
        if (std::filesystem::exists(folder / "trochoid-server")) return folder / "trochoid-server";
    throw OperatorError(
        fmt::format("there is no trochoid-server in {} or beside it: build that target", here.string()));
}

std::string text_of_file(const path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

path new_folder() {
    std::string name = (std::filesystem::temp_directory_path() / "trochoid-server.XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw OperatorError("cannot make a folder for temporary files");
    return name;
}

SigningKey test_key() {
    std::array<uint8_t, SigningKey::bytes> seed{};
    seed[0] = 1;
    return SigningKey::from_seed(seed);
}

int spawn(const std::vector<std::string>& words, const path& log) {
    std::vector<char*> arguments;
    arguments.reserve(words.size() + 1);
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t actions{};
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, 1, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    posix_spawn_file_actions_adddup2(&actions, 1, 2);
    pid_t process = 0;
    const int failed = posix_spawn(&process, arguments[0], &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    if (failed != 0) throw OperatorError(fmt::format("cannot start {}", words[0]));
    return process;
}

void pin_task(int task, const std::vector<int>& cores) {
    cpu_set_t set;
    CPU_ZERO(&set);
    for (const int core : cores) CPU_SET(static_cast<size_t>(core), &set);
    sched_setaffinity(task, sizeof set, &set);
    // A thread that gives way to others of its own will goes on doing so.
    if (getpriority(PRIO_PROCESS, static_cast<id_t>(task)) > 0) return;
    sched_param first{};
    first.sched_priority = 1;
    sched_setscheduler(task, SCHED_RR, &first);
}

void pin_process(const path& tasks, const std::vector<int>& cores) {
    for (const auto& task : std::filesystem::directory_iterator(tasks))
        pin_task(std::stoi(task.path().filename().string()), cores);
}

}  // namespace

std::string ServerProcess::director_token(const std::string& world) {
    const auto since = std::chrono::system_clock::now().time_since_epoch();
    const auto now = static_cast<uint64_t>(std::chrono::duration_cast<std::chrono::seconds>(since).count());
    return sign_token({Role::director, {now}, {now + usual_token_life}, random_nonce(), world}, test_key());
}

ServerProcess::ServerProcess(const std::string& scene, std::vector<std::string> options)
    : folder_(new_folder()) {
    path scene_file = scene;
    if (!scene.ends_with(".toml")) {
        scene_file = folder_ / "scene.toml";
        std::ofstream(scene_file) << scene;
    }
    std::ofstream(folder_ / "key.pub") << test_key().public_key().pem();
    std::vector<std::string> words{server_program().string(),
                                   "--scene",
                                   scene_file.string(),
                                   "--port",
                                   "0",
                                   "--port-file",
                                   (folder_ / "port").string(),
                                   "--token-key",
                                   (folder_ / "key.pub").string()};
    words.insert(words.end(), options.begin(), options.end());
    process_ = spawn(words, folder_ / "log");
    const auto until = std::chrono::steady_clock::now() + start_patience;
    while (!std::filesystem::exists(folder_ / "port")) {
        int status = 0;
        if (over(status) || std::chrono::steady_clock::now() > until) {
            const std::string said = log();
            if (process_ != 0) kill();
            std::filesystem::remove_all(folder_);
            throw OperatorError(fmt::format("the server did not start:\n{}", said));
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    port_ = static_cast<uint16_t>(std::stoi(text_of_file(folder_ / "port")));
}

ServerProcess::~ServerProcess() {
    if (process_ != 0) kill();
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
}

bool ServerProcess::over(int& status) const {
    if (process_ == 0) return true;
    return ::waitpid(process_, &status, WNOHANG) == process_;
}

std::string ServerProcess::log() const { return text_of_file(folder_ / "log"); }

uint64_t ServerProcess::memory() const {
    std::smatch found;
    const std::string status = text_of_file(fmt::format("/proc/{}/status", process_));
    if (!std::regex_search(status, found, std::regex("RssAnon:\\s+(\\d+) kB"))) return 0;
    return std::stoull(found[1]) * 1024;
}

double ServerProcess::processor_seconds() const {
    const std::string stat = text_of_file(fmt::format("/proc/{}/stat", process_));
    std::istringstream after(stat.substr(stat.rfind(')') + 2));
    std::vector<std::string> words{std::istream_iterator<std::string>(after), {}};
    return static_cast<double>(std::stoull(words.at(11)) + std::stoull(words.at(12))) /
           static_cast<double>(::sysconf(_SC_CLK_TCK));
}

void ServerProcess::pin(const std::vector<int>& cores) const {
    pin_process(fmt::format("/proc/{}/task", process_), cores);
}

void pin_ourselves(const std::vector<int>& cores) { pin_process("/proc/self/task", cores); }

void give_way_to_others() {
    const sched_param none{};
    // Idle class: also the kernel's own threads, which deliver everybody's packets, go first.
    sched_setscheduler(0, SCHED_IDLE, &none);
}

void ServerProcess::freeze() const { ::kill(process_, SIGSTOP); }
void ServerProcess::thaw() const { ::kill(process_, SIGCONT); }

void ServerProcess::kill() {
    if (process_ == 0) return;
    ::kill(process_, SIGKILL);
    int status = 0;
    ::waitpid(process_, &status, 0);
    process_ = 0;
}

bool ServerProcess::stop(std::chrono::milliseconds within) {
    if (process_ == 0) return false;
    ::kill(process_, SIGTERM);
    const auto until = std::chrono::steady_clock::now() + within;
    int status = 0;
    while (!over(status)) {
        if (std::chrono::steady_clock::now() > until) return false;
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    process_ = 0;
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

std::string ServerProcess::said_last(const std::string& from, const std::string& until) const {
    const std::string said = log();
    const size_t begin = said.rfind(from);
    if (begin == std::string::npos) return {};
    return said.substr(begin + from.size(), said.find(until, begin) - begin - from.size());
}

namespace {

// Of a text like "101: 12, 302: 4".
std::map<uint32_t, uint64_t> counts_in(const std::string& text) {
    std::map<uint32_t, uint64_t> counts;
    const std::regex pair("(\\d+): (\\d+)");
    for (std::sregex_iterator at(text.begin(), text.end(), pair), end; at != end; ++at)
        counts[static_cast<uint32_t>(std::stoul((*at)[1]))] = std::stoull((*at)[2]);
    return counts;
}

uint64_t number_of(const std::string& text) { return text.empty() ? 0 : std::stoull(text); }

}  // namespace

std::map<uint32_t, uint64_t> ServerProcess::ended_by_code() const {
    return counts_in(said_last("ended by code ", ", refused by code"));
}

std::map<uint32_t, uint64_t> ServerProcess::http_answers() const {
    return counts_in(said_last("; HTTP answers ", "\n"));
}

uint64_t ServerProcess::connections() const { return number_of(said_last("stopped: ", " connections")); }

uint64_t ServerProcess::connections_at_the_door() const {
    return number_of(said_last("at the door: ", " connections"));
}

}  // namespace trochoid
