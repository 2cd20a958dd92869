import java.io.IOException;
import java.net.InetAddress;
import java.net.InetSocketAddress;
import java.nio.ByteBuffer;
import java.nio.channels.*;
import java.nio.charset.StandardCharsets;
import java.util.*;
import java.util.regex.*;

/**
 * A robot's client in Java 17, without libraries; docs/protocol.md is the protocol that it speaks, version 2 or 1.
 *
 * <p>{@code java PslvClient.java [--raw] [TEAM [NUMBER [HOST [PORT [VIEWS [OPTIONS [VX VY OMEGA]]]]]]]}, as OPTIONS:
 * "(types team) (rate 10)". The team's key, if it has one, is read from the variable PSLV_KEY: other users can read the
 * words of a command. Copy the file and replace main: the constructor, then next in your loop, then close.
 */
public final class PslvClient implements AutoCloseable {
    private static final double RETRY_S = 0.5; // between two inits until one is answered
    private static final double PATIENCE_S = 1.0; // after a passing error; silence, until the session port is asked
    private static final double RESTART_S = 3.0; // silence, until the main port is asked: is it a restarted server?
    private static final double LEASE_S = 15.0; // assumed where the server does not tell it
    private static final double NS_PER_S = 1e9;
    private static final int NOTHING_PX = 255;
    private static final int AT_ONCE = 1000;
    private static final String NUMBER = "(-?\\d+(?:\\.\\d+)?(?:e[-+]?\\d+)?)";
    private static final Pattern HEAD = Pattern.compile("\\((\\w+) ?([^ ()]*)");
    private static final Pattern SEE = Pattern.compile(
            "\\(see (\\d{1,10}(?:\\.\\d+)?) \\(\\(edge\\) ((?:[!-'*-~][0-9a-f]{2})*+)\\)"
                    + " \\(\\(ball\\) (-?\\d{1,3}) (-?\\d{1,3}) (-?\\d{1,3})\\)(.*)\\)",
            Pattern.DOTALL);
    private static final Set<String> PASSING = Set.of("not_ready", "rate_limited", "not_connected");
    private static final Map<String, String> MEANINGS = Map.of(
            "already_connected", "another program has this robot, and it still runs",
            "not_admitted", "the server does not serve this computer (its key admission.subnets)",
            "replaced", "a newer program has this robot",
            "unknown_command", "the server does not tell its mirror",
            "wrong_key", "this is not the team's key");

    /** The nearest edge in one direction: px is -1 and mm infinite when nothing is within range. */
    public record Edge(char letter, int px, double mm, double directionDeg) {}

    /** The ball: px is -1 and mm infinite when it is hidden. */
    public record Ball(int px, int directionDeg, int sizeDeg, double mm) {}

    /** What the robot saw at timeS, seconds since the server's start. unseen: the camera does not see the robot now. */
    public record View(double timeS, List<Edge> edges, Ball ball, boolean unseen) {}

    private final DatagramChannel channel;
    private final Selector selector;
    private final ByteBuffer buffer = ByteBuffer.allocate(2048);
    private final InetSocketAddress mainPort;
    private final String robot;
    private InetSocketAddress server; // where views come from
    private boolean open; // init was answered, and the mirror is known
    private int version; // that the server speaks; 0: not known yet
    private String waiting = ""; // an error that passes, as not_ready; empty: none
    private String ended = "";
    private String cookie = "", boot = "";
    private double leaseS = LEASE_S;
    private double[] mirror = {};
    private double[] fov = {360.0, 180.0}; // width and center [deg]
    private double resolution = 1.0; // between two directions [deg]
    private double timeS = -1.0; // of the last view
    private double heardS = nowS() - RESTART_S;
    private double askedS;

    /** Ask for a robot's views. options: as "(types team) (rate 10)"; key: the team's. next shows if it is answered. */
    public PslvClient(String host, int port, String team, int number, String options, String key) throws IOException {
        mainPort = server = new InetSocketAddress(InetAddress.getByName(host), port);
        robot = team + " " + number + " (version 2) " + options + (key.isEmpty() ? "" : " (key " + key + ")");
        selector = Selector.open();
        channel = DatagramChannel.open();
        channel.configureBlocking(false);
        channel.register(selector, SelectionKey.OP_READ);
        ask(mainPort);
    }

    /**
     * Wait for a view that is newer than the last one, and take the newest that has arrived; null if none came in time.
     * This keeps the session alive.
     *
     * @throws IOException when the server has ended the session; the message says why
     */
    public View next(double timeoutS) throws IOException {
        double deadlineS = nowS() + timeoutS;
        while (true) {
            View newest = null;
            buffer.clear();
            for (int i = 0; i < AT_ONCE && channel.receive(buffer) instanceof InetSocketAddress from; i++) {
                String text = new String(buffer.array(), 0, buffer.position(), StandardCharsets.ISO_8859_1);
                View view = from.getAddress().equals(mainPort.getAddress()) ? take(text, from) : null;
                newest = view == null ? newest : view;
                buffer.clear();
            }
            if (!ended.isEmpty()) throw new IOException(ended);
            askIfDue();
            double leftS = deadlineS - nowS();
            if (newest != null || leftS <= 0.0) return newest;
            selector.select(1 + (long) (1e3 * Math.min(leftS, 0.1)));
            selector.selectedKeys().clear();
        }
    }

    /** Drive a simulated robot: forward, left [m/s], anticlockwise [rad/s]; kick: speed [m/s], or 0. Not answered. */
    public void drive(double vx, double vy, double omega, double kick, boolean dribble) {
        String text = String.format(Locale.ROOT, "(drive %.4f %.4f %.4f (kick %.4f)", vx, vy, omega, kick);
        send(text + (dribble ? " (dribble))" : ")"), server);
    }

    /** End the session. */
    @Override
    public void close() throws IOException {
        bye();
        channel.close();
        selector.close();
    }

    private void bye() {
        if (version != 0 && ended.isEmpty()) send("(bye)", server);
    }

    private void send(String text, InetSocketAddress to) {
        try {
            channel.send(ByteBuffer.wrap(text.getBytes(StandardCharsets.ISO_8859_1)), to);
        } catch (IOException down) {
            // the network is down: the server's silence shows it
        }
    }

    /** Send init. Only version 1 has to be asked for the mirror. */
    private void ask(InetSocketAddress to) {
        String proof = cookie.isEmpty() ? "" : " (cookie " + cookie + ")";
        send("(init " + robot + proof + ")" + (version == 1 ? "(mirror)" : ""), to);
        askedS = nowS();
    }

    /** Repeat init until it is answered; then to keep the session, and to learn what a lost message would have told. */
    private void askIfDue() {
        double silentS = nowS() - heardS;
        if (silentS >= RESTART_S) {
            open = false;
            version = 0;
        }
        double waitS = !open ? RETRY_S : silentS >= PATIENCE_S ? PATIENCE_S : Math.max(leaseS / 3.0, RETRY_S);
        if (nowS() - askedS >= waitS) ask(open ? server : mainPort);
    }

    /** Take a message of the server; returns a view that is newer than the last one, or null. */
    private View take(String datagram, InetSocketAddress from) {
        String text = datagram.replaceFirst("[\\x00\\s]+\\z", "");
        Matcher head = HEAD.matcher(text);
        if (!head.lookingAt()) return null;
        String name = head.group(1);
        String word = head.group(2);
        if (name.equals("error") && !word.isEmpty()) {
            takeError(word);
            return null;
        }
        heardS = nowS();
        waiting = "";
        if (name.equals("see")) return takeSee(text, from);
        if (name.equals("init") && !word.isEmpty()) takeInit(text, from);
        if (name.equals("mirror")) open |= takeMirror(text, "\\(mirror ") && version == 1;
        if (name.equals("hear")) takeMirror(text, " mirror ");
        if (name.equals("ping")) send(text, from);
        if (name.equals("challenge") && !word.isEmpty()) {
            cookie = word;
            ask(from);
        }
        // a match has begun: its mirror and field of view are in the answer to init
        if (text.equals("(warning fixed_by_match)") && open && nowS() - askedS >= PATIENCE_S) ask(from);
        return null;
    }

    /** An error that passes: ask again a second later. Any other ends the session. */
    private void takeError(String error) {
        if (PASSING.contains(error)) {
            waiting = error;
            open = false;
            askedS = nowS() + PATIENCE_S - RETRY_S;
        } else {
            ended = "error " + error + ": " + MEANINGS.getOrDefault(error, "see docs/protocol.md");
        }
    }

    /** The answer to init: facts in version 2, none in version 1, where the mirror has to be asked for. */
    private void takeInit(String text, InetSocketAddress from) {
        Matcher named = Pattern.compile("\\(boot ([^()]*)\\)").matcher(text);
        String told = named.find() ? named.group(1) : "";
        if (told.isEmpty() || !told.equals(boot)) timeS = -1.0; // Time has begun anew
        boot = told;
        server = from;
        double[] lease = numbersAfter(text, "\\(lease ", 1);
        version = lease.length == 1 && takeMirror(text, "\\(mirror ") ? 2 : 1;
        leaseS = version == 2 ? lease[0] : LEASE_S;
        double[] width = numbersAfter(text, "\\(fov ", 2), step = numbersAfter(text, "\\(resolution ", 1);
        fov = width.length == 2 ? width : fov;
        resolution = step.length == 1 ? step[0] : resolution;
        if (version == 2) open = true;
        else if (!open) send("(mirror)", from);
    }

    private boolean takeMirror(String text, String mark) {
        double[] found = numbersAfter(text, mark, 3);
        if (found.length < 3) return false;
        boolean valid = found[2] > 0.0 && found[1] >= 0.0 && found[0] > found[1] * Math.sqrt(found[2]);
        if (valid) mirror = found;
        return valid;
    }

    private View takeSee(String text, InetSocketAddress from) {
        Matcher see = SEE.matcher(text);
        if (!open || !see.matches() || Double.parseDouble(see.group(1)) <= timeS) return null;
        timeS = Double.parseDouble(see.group(1));
        server = from;
        String sent = see.group(2);
        List<Edge> edges = new ArrayList<>();
        for (int i = 0; 3 * i < sent.length(); i++) {
            int value = Integer.parseInt(sent.substring(3 * i + 1, 3 * i + 3), 16);
            int edgePx = value == NOTHING_PX ? -1 : value;
            double directionDeg = (fov[1] - fov[0] / 2.0 + 720.0 + i * resolution) % 360.0;
            edges.add(new Edge(sent.charAt(3 * i), edgePx, mmFromPx(edgePx), directionDeg));
        }
        int px = Integer.parseInt(see.group(3));
        Ball ball = new Ball(px, Integer.parseInt(see.group(4)), Integer.parseInt(see.group(5)), mmFromPx(px));
        return new View(timeS, edges, ball, see.group(6).contains("nopose"));
    }

    /** Distance on the floor; the server rounds pixels down, so their middle is half a pixel more. */
    private double mmFromPx(int px) {
        double r = px + 0.5;
        double slope = mirror[0] - mirror[1] * Math.sqrt(mirror[2] + r * r);
        return px >= 0 && slope > 0.0 ? r / slope : Double.POSITIVE_INFINITY;
    }

    private static double nowS() {
        return System.nanoTime() / NS_PER_S;
    }

    /** The numbers that follow a mark, anywhere in a message; empty when they do not. */
    private static double[] numbersAfter(String text, String mark, int count) {
        Matcher found = Pattern.compile(mark + String.join(" ", Collections.nCopies(count, NUMBER))).matcher(text);
        double[] numbers = new double[found.find() ? count : 0];
        for (int i = 0; i < numbers.length; i++) numbers[i] = Double.parseDouble(found.group(i + 1));
        return numbers;
    }

    /** Time, edges as the server sent them, the ball's pixels, direction and size, mm ahead and to the ball. */
    private static String rawLine(View view) {
        StringBuilder sent = new StringBuilder();
        for (Edge edge : view.edges) sent.append(String.format("%c%02x", edge.letter, edge.px & NOTHING_PX));
        Ball ball = view.ball;
        String ahead = rawMm(view.edges.isEmpty() ? Double.POSITIVE_INFINITY : view.edges.get(0).mm);
        return String.format(Locale.ROOT, "%.3f %s %d %d %d %s %s",
                view.timeS, sent, ball.px, ball.directionDeg, ball.sizeDeg, ahead, rawMm(ball.mm));
    }

    private static String rawMm(double mm) {
        return Double.isInfinite(mm) ? "-" : String.format(Locale.ROOT, "%.1f", mm);
    }

    private static String line(View view) {
        if (view.unseen) return String.format(Locale.ROOT, "%.3f s: the camera does not see the robot", view.timeS);
        Edge edge = view.edges.isEmpty() ? new Edge('-', -1, Double.POSITIVE_INFINITY, 0.0) : view.edges.get(0);
        String ahead = edge.px < 0 ? "nothing" : edge.letter + " at " + edge.px + " px";
        String ball = view.ball.px < 0 ? "hidden" : view.ball.px + " px at " + view.ball.directionDeg + " deg";
        return String.format(Locale.ROOT, "%.3f s: ahead %s, ball %s", view.timeS, ahead, ball);
    }

    public static void main(String[] all) {
        boolean raw = all.length > 0 && all[0].equals("--raw");
        String[] given = {"blue", "3", "127.0.0.1", "6000", "100", ""};
        List<String> words = List.of(all).subList(raw ? 1 : 0, all.length);
        for (int i = 0; i < Math.min(words.size(), 6); i++) given[i] = words.get(i);
        double[] speed = words.stream().skip(6).mapToDouble(Double::parseDouble).toArray();
        int seen = 0;
        int number = Integer.parseInt(given[1]), port = Integer.parseInt(given[3]);
        String key = System.getenv().getOrDefault("PSLV_KEY", "");
        try (PslvClient robot = new PslvClient(given[2], port, given[0], number, given[5], key)) {
            Runtime.getRuntime().addShutdownHook(new Thread(robot::bye)); // also by Ctrl-C
            while (seen < Integer.parseInt(given[4])) {
                View view = robot.next(5.0);
                if (view != null) {
                    seen++;
                    System.out.println(raw ? rawLine(view) : line(view));
                    if (speed.length > 0) robot.drive(speed[0], speed[1], speed[2], 0.0, false);
                    continue;
                }
                String why = robot.open ? "the camera does not see the robot" : "nothing answers at that address";
                System.err.println("no view for 5 s: " + (robot.waiting.isEmpty() ? why : robot.waiting));
                if (seen == 0 && robot.waiting.isEmpty()) break;
            }
        } catch (IOException error) {
            System.err.println(error.getMessage());
            seen = 0;
        }
        System.exit(seen == 0 ? 1 : 0);
    }
}
