a = DeclareLaunchArgument('yaw', default_value='0.1')
def tf(x, child='laser'):
    return Node(package='tf2_ros', executable='static_transform_publisher', arguments=['--x', str(-x / 2), '--yaw', LaunchConfiguration('yaw'), '--frame-id', f'{"base"}', '--child-frame-id', child])
D = LaunchDescription([tf(1.0), tf(math.pi, child='camera')])
