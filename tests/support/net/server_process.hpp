#pragma once
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace trochoid {

/// The real `trochoid-server` as a process of its own, on a free port of loopback, with a key that signs tokens. Ends with its
/// owner.
class ServerProcess {
public:
    /// A fresh director's token for the world of this name; each is good for one connection.
    static std::string director_token(const std::string& world);

    /// `scene`: the text of a scene file, or the path of one of the repository's (ends in .toml). Throws OperatorError
    /// where the server does not start; the message holds its log.
    explicit ServerProcess(const std::string& scene, std::vector<std::string> options = {});
    ServerProcess(const ServerProcess&) = delete;
    ServerProcess& operator=(const ServerProcess&) = delete;
    ~ServerProcess();

    uint16_t port() const { return port_; }
    std::string log() const;
    /// Bytes of memory in use that are the process's own.
    uint64_t memory() const;
    /// Processor seconds used so far.
    double processor_seconds() const;
    /// Only on these cores, and there before everything else on the machine (where that is allowed), so that timings are those
    /// of an idle one.
    void pin(const std::vector<int>& cores) const;
    /// Stops the process where it stands (SIGSTOP), and lets it go on.
    void freeze() const;
    void thaw() const;
    /// Ends at once, as by kill -9.
    void kill();
    /// SIGTERM; false where it does not end within the time, or not well.
    bool stop(std::chrono::milliseconds within = std::chrono::seconds(10));
    /// How sessions ended, by code, as the server counted them; after `stop`.
    std::map<uint32_t, uint64_t> ended_by_code() const;
    /// HTTP answers by status, which no code stands for: each ended a connection as well; after `stop`.
    std::map<uint32_t, uint64_t> http_answers() const;
    /// Sessions and connections that the server has counted; after `stop`.
    uint64_t connections() const;
    /// Connections that came to the door, whatever became of them; after `stop`.
    uint64_t connections_at_the_door() const;

private:
    bool over(int& status) const;
    /// What stands between those words in the log, the last time that it does; empty: nowhere.
    std::string said_last(const std::string& from, const std::string& until) const;
    std::filesystem::path folder_;
    int process_ = 0;
    uint16_t port_ = 0;
};

/// The same for this whole process, all its present threads and those that they start.
void pin_ourselves(const std::vector<int>& cores);
/// The calling thread runs only where those that are pinned leave the core to it.
void give_way_to_others();

}  // namespace trochoid
