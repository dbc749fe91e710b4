// A node of ROS 2 on the robot itself: base.rv judged in C, without Python and without a heap of
// its own. Each verdict is published as a line on `verdicts`, such as `B2#1 F`.
//
// It was compiled and run against a stub of rclcpp, not with ROS.
#include "base.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <string>

#include <nav_msgs/msg/odometry.hpp>
#include <rclcpp/rclcpp.hpp>
#include <sensor_msgs/msg/range.hpp>
#include <std_msgs/msg/bool.hpp>
#include <std_msgs/msg/string.hpp>

class BaseMonitor : public rclcpp::Node {
public:
    BaseMonitor()
        : Node("base_monitor"),
          verdicts_(create_publisher<std_msgs::msg::String>("verdicts", 100)),
          monitor_(64, [this](const base_record &record) { tell(record); })
    {
        const auto qos = rclcpp::SensorDataQoS();
        odom_ = create_subscription<nav_msgs::msg::Odometry>(
            "odom", qos, [this](nav_msgs::msg::Odometry::ConstSharedPtr message) {
                const auto &velocity = message->twist.twist.linear;
                update(BASE_SIGNAL_0 /* speed */, std::hypot(velocity.x, velocity.y));
            });
        range_ = create_subscription<sensor_msgs::msg::Range>(
            "range", qos, [this](sensor_msgs::msg::Range::ConstSharedPtr message) {
                update(BASE_SIGNAL_1 /* obstacle */, message->range);
            });
        stop_ = create_subscription<std_msgs::msg::Bool>(
            "stop", 10, [this](std_msgs::msg::Bool::ConstSharedPtr message) {
                if (message->data && !stops_) {
                    base_sample sample = {};
                    sample.event[BASE_EVENT_0 /* stop_request */] = base_YES;
                    monitor_.step(later(), sample);
                }
                stops_ = message->data;
            });
        // By the clock of the node, which follows /clock where use_sim_time is set. A deadline is
        // told so much later at most; its instant is exact.
        timer_ = rclcpp::create_timer(this, get_clock(), std::chrono::milliseconds(10), [this]() {
            monitor_.advance(now().nanoseconds());
        });
    }

private:
    void update(int signal, double value)
    {
        base_sample sample = {};
        sample.signal[signal] = base_YES;
        sample.value[signal] = value;
        monitor_.step(later(), sample);
    }

    // Samples have instants of their own, also where messages come at once.
    std::int64_t later() { return last_ = std::max(now().nanoseconds(), last_ + 1); }

    void tell(const base_record &record)
    {
        static const char *const verdicts[] = {"F", "P", "I", "NT"};
        std_msgs::msg::String message;
        message.data = "B" + std::to_string(record.requirement + 1) + (record.in_doubt ? "?" : "#") +
                       std::to_string(record.number) + " " + verdicts[record.verdict];
        verdicts_->publish(message);
        if (record.verdict == base_FAIL) {
            RCLCPP_ERROR(get_logger(), "%s", message.data.c_str());
        }
    }

    rclcpp::Publisher<std_msgs::msg::String>::SharedPtr verdicts_;
    base::Monitor monitor_;
    rclcpp::Subscription<nav_msgs::msg::Odometry>::SharedPtr odom_;
    rclcpp::Subscription<sensor_msgs::msg::Range>::SharedPtr range_;
    rclcpp::Subscription<std_msgs::msg::Bool>::SharedPtr stop_;
    rclcpp::TimerBase::SharedPtr timer_;
    std::int64_t last_ = -1;
    bool stops_ = false;
};

int main(int argc, char **argv)
{
    rclcpp::init(argc, argv);
    rclcpp::spin(std::make_shared<BaseMonitor>());
    rclcpp::shutdown();
}
