// The scenes that the page offers. `dt` is the time step in s.

const named = (title, file, about, dt = 0.01) => ({ title, file: `scenes/${file}.txt`, about, dt });

export const GALLERY = [
    { title: "Grains", grains: true, about: "As many grains as this device can simulate in real time fall into a box.", dt: 0.02 },
    named("Rockfall", "rockfall", "Rocks and two boulders come down a stair and knock over ten pins."),
    named("Dominoes", "dominoes", "A row of boxes around a bend: each knocks over the next.", 1 / 60),
    named("Tower of bricks", "tower", "A ball hits a tower of thirty bricks.", 1 / 60),
    named("House of cards", "cards", "A ball rolls into a house of cards of three storeys.", 1 / 60),
    named("Linkage", "linkage", "Motors drive a four-bar linkage and a crank with a slider.", 1 / 60),
    named("Clock", "escapement", "A motor, a wheel with teeth, an anchor and a pendulum: an escapement that ticks.", 1 / 60),
    named("Marble machine", "marbles", "Marbles roll down ramps and move a rocker, a wheel and a bucket.", 1 / 60),
    named("Ragdolls", "ragdolls", "Three ragdolls fall down a flight of stairs.", 1 / 60),
    named("Wrecking ball", "crane", "A crane swings a ball on a chain into a wall of bricks.", 1 / 60),
    named("Tower of capsules", "capsules", "A heavy ball hits a tower of logs."),
    named("Conveyor", "conveyor", "Logs slide down a slope, ride on a belt and drop into a bin."),
    named("Hanging bridge", "bridge", "Balls drop on a bridge of rods of fixed length."),
    named("Soft cube", "soft-cube", "A cube of spheres and springs.", 0.005),
    named("Looks", "looks", "A table of wood, stones, and a tank of glass full of balls.", 0.004),
    named("Cradle", "cradle", "Newton's cradle.", 0.005),
    named("Creature: galloper", "creatures/galloper", "A creature of springs and muscles that evolved to walk.", 0.005),
    named("Creature: rocker", "creatures/rocker", "A creature of springs and muscles that evolved to walk.", 0.005),
    named("Creature: shuffler", "creatures/shuffler", "A creature of springs and muscles that evolved to walk.", 0.005),
    named("Creature: sprinter", "creatures/sprinter", "A creature of springs and muscles that evolved to walk.", 0.005),
    named("Creature: strider", "creatures/strider", "A creature of springs and muscles that evolved to walk.", 0.005),
];
