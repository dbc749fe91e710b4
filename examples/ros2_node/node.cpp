// A node of ROS 2 on the robot itself: base.rv judged in C, without Python. Each verdict is published as a line on `verdicts`, such as `B2#1 F`.
//
// It was compiled and run against a stub of rclcpp, not with ROS.
#include "base_plan.h"
#include "rvmon_core.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <initializer_list>
#include <memory>
#include <stdexcept>
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
          monitor_(base_plan, sizeof base_plan)
    {
        if (!monitor_) {
            throw std::runtime_error("no memory for the monitor");
        }
        const auto qos = rclcpp::SensorDataQoS();
        odom_ = create_subscription<nav_msgs::msg::Odometry>(
            "odom", qos, [this](nav_msgs::msg::Odometry::ConstSharedPtr message) {
                const auto &velocity = message->twist.twist.linear;
                step({rvmon::real(BASE_SIGNAL_SPEED, std::hypot(velocity.x, velocity.y))});
            });
        range_ = create_subscription<sensor_msgs::msg::Range>(
            "range", qos, [this](sensor_msgs::msg::Range::ConstSharedPtr message) {
                step({rvmon::real(BASE_SIGNAL_OBSTACLE, message->range)});
            });
        stop_ = create_subscription<std_msgs::msg::Bool>(
            "stop", 10, [this](std_msgs::msg::Bool::ConstSharedPtr message) {
                if (message->data && !stops_) {
                    step({rvmon::occurs(BASE_EVENT_STOP_REQUEST)});
                }
                stops_ = message->data;
            });
        // By the clock of the node, which follows /clock where use_sim_time is set. A deadline is
        // told so much later at most; its instant is exact.
        timer_ = rclcpp::create_timer(this, get_clock(), std::chrono::milliseconds(10), [this]() {
            tell(monitor_.advance(now().nanoseconds()));
        });
    }

private:
    void step(std::initializer_list<rv_update> updates) { tell(monitor_.step(later(), updates)); }

    // Samples have instants of their own, also where messages come at once.
    std::int64_t later() { return last_ = std::max(now().nanoseconds(), last_ + 1); }

    void tell(int code)
    {
        if (code != RV_OK) {
            RCLCPP_ERROR(get_logger(), "the monitor says %d", code);
        }
        monitor_.records([this](const rv_record &record) {
            static const char *const verdicts[] = {"F", "P", "I", "NT"};
            std_msgs::msg::String message;
            message.data = base_requirements[record.requirement];
            message.data += (record.in_doubt ? "?" : "#") + std::to_string(record.number) + " " +
                            verdicts[record.verdict];
            verdicts_->publish(message);
            if (record.verdict == RV_FAIL) {
                RCLCPP_ERROR(get_logger(), "%s", message.data.c_str());
            }
        });
    }

    rclcpp::Publisher<std_msgs::msg::String>::SharedPtr verdicts_;
    rvmon::Monitor monitor_;
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
