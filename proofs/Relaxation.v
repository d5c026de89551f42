(* Laws dz/dt = v - share (m/g) z: bounded and passive, also where the level varies. *)
From Coq Require Import Reals Lra Psatz.
From Coquelicot Require Import Coquelicot.
From Stribeck Require Import Laws Motion Power Terms Continuous.
Open Scope R_scope.

Lemma motion_ext {U : UniformSpace} (f f' : U -> R -> R) (ok : U -> Prop) u z a b :
  (forall w x, ok w -> f w x = f' w x) -> (forall t, a <= t <= b -> ok (u t)) ->
  motion f u z a b -> motion f' u z a b.
Proof.
  intros E Hok M. induction M as [a | a b c M IH P]; [apply at_once|].
  assert (L := motion_le _ _ _ _ _ M). destruct P as [Hbc (u' & z' & Hu & Hz & Ez & Hd)].
  apply onward with b.
  - apply IH. intros t Ht. apply Hok. lra.
  - split; [exact Hbc|]. exists u', z'. split; [exact Hu|]. split; [exact Hz|]. split; [exact Ez|].
    intros t Ht. destruct (Hd t Ht) as [D1 D2]. split; [exact D1|]. rewrite <- E by (apply Hok; lra). exact D2.
Qed.

Lemma storage_ext {U : UniformSpace} (f f' p p' : U -> R -> R) (ok : U -> Prop) within S :
  (forall w x, ok w -> f' w x = f w x) -> (forall w x, ok w -> p w x = p' w x) ->
  storage f ok p within S -> storage f' ok p' within S.
Proof.
  intros E Ep [H0 H]. split; [exact H0|]. intros u z a b M Hok Hz.
  assert (L := motion_le _ _ _ _ _ M).
  destruct (H u z a b) as [X I]; auto; [apply (motion_ext f' f ok); auto|].
  assert (Q : forall t, Rmin a b < t < Rmax a b -> p (u t) (z t) = p' (u t) (z t)).
  { intros t Ht. rewrite Rmin_left, Rmax_right in Ht by lra. apply Ep, Hok. lra. }
  split; [apply (ex_RInt_ext (fun t => p (u t) (z t))); auto|].
  rewrite (RInt_ext (fun t => p' (u t) (z t)) (fun t => p (u t) (z t))); [exact I|].
  intros t Ht. symmetry. apply Q; exact Ht.
Qed.

(* Fewer inputs, the same storage. *)
Lemma storage_less {U : UniformSpace} (f p : U -> R -> R) (ok ok' : U -> Prop) within S :
  (forall w, ok' w -> ok w) -> storage f ok p within S -> storage f ok' p within S.
Proof. intros L [H0 H]. split; [exact H0|]. intros u z a b M Hok. apply H; auto. Qed.

(* What the theorems use of a law's equation. ok: what is allowed of the constants; m0 = m(0). *)
Record relaxation (ok : constants -> Prop) (dz : constants -> R -> R -> R) (m : constants -> R -> R)
  (m0 : constants -> R) (share : constants -> R -> R -> R) : Prop := {
  r_constants : forall p, ok p -> 0 < sigma_0 p /\ 0 <= sigma_1 p /\ 0 <= sigma_2 p /\ 0 < F_c p <= F_s p;
  r_level : forall p Fc Fs, ok p -> F_c p <= Fc <= Fs -> ok (at_level p Fc Fs);
  r_majorant : forall p v, ok p -> Rabs v <= m p v <= Rabs v + m0 p;
  r_majorant_level : forall p Fc Fs v, m (at_level p Fc Fs) v = m p v;
  r_share : forall p v z, ok p -> 0 <= share p v z <= 1;
  r_beyond : forall p v z, ok p -> g p v <= Rabs z -> share p v z = 1 \/ (v * z <= 0 /\ share p v z = 0);
  r_rate : forall p v z, ok p -> dz p v z = v - share p v z * m p v / g p v * z;
  r_continuous : forall (U : UniformSpace) p (vel Fc Fs : U -> R), ok p -> (forall w, continuous vel w) ->
    (forall w, continuous Fc w) -> (forall w, continuous Fs w) -> (forall w, F_c p <= Fc w <= Fs w) ->
    continuous_2 (fun w z => dz (at_level p (Fc w) (Fs w)) (vel w) z) }.

Section Theorems.
Variables (ok : constants -> Prop) (dz : constants -> R -> R -> R) (m : constants -> R -> R) (m0 : constants -> R).
Variables (share : constants -> R -> R -> R) (damping : constants -> R -> R) (friction : constants -> R -> R -> R).
Hypothesis law : relaxation ok dz m m0 share.
Hypothesis damping_range : forall p v, ok p -> 0 <= damping p v <= sigma_1 p.
Hypothesis damping_level : forall p Fc Fs v, damping (at_level p Fc Fs) v = damping p v.
Hypothesis damping_continuous : forall p v, ok p -> continuous (damping p) v.
Hypothesis friction_is : forall p v z, friction p v z = sigma_0 p * z + damping p v * dz p v z + sigma_2 p * v.

Section Input.
Context {U : UniformSpace}.
Variables (p : constants) (vel Fc Fs : U -> R).
Hypothesis Hp : ok p.
Hypothesis Hvel : forall w, continuous vel w.
Hypothesis HFc : forall w, continuous Fc w.
Hypothesis HFs : forall w, continuous Fs w.
Hypothesis Hlevel : forall w, F_c p <= Fc w <= Fs w /\ Fs w <= F_s p.
Let q w := at_level p (Fc w) (Fs w).
Let N w := sigma_0 p * g (q w) (vel w).
Let al w z := share (q w) (vel w) z.
Let d w := damping p (vel w).

Let okq w : ok (q w).
Proof. apply (r_level _ _ _ _ _ law); [exact Hp|apply Hlevel]. Qed.

Let cs : 0 < sigma_0 p /\ 0 <= sigma_1 p /\ 0 <= sigma_2 p /\ 0 < F_c p <= F_s p.
Proof. apply (r_constants _ _ _ _ _ law p Hp). Qed.

Let N_range w : F_c p <= N w <= F_s p.
Proof.
  destruct (Hlevel w) as [[L1 L2] L3]. pose proof (g_newtons (q w) (vel w)) as G.
  change (sigma_0 p * g (q w) (vel w)) with (N w) in G. simpl in G. destruct cs as (? & _).
  assert (Fc w <= N w <= Fs w) by (apply G; auto). lra.
Qed.

Let gN w : g (q w) (vel w) = N w / sigma_0 p.
Proof. unfold N. destruct cs as (? & _). field. lra. Qed.

Let rate_is w z : dz (q w) (vel w) z = rate (sigma_0 p) vel (fun w => m p (vel w)) N al w z.
Proof.
  rewrite (r_rate _ _ _ _ _ law) by apply okq.
  replace (m (q w) (vel w)) with (m p (vel w)) by (symmetry; apply (r_majorant_level _ _ _ _ _ law)). unfold rate, al.
  rewrite gN. pose proof (N_range w). destruct cs as (? & ? & ? & ? & ?). field. lra.
Qed.

Let power_is w z : friction (q w) (vel w) z * vel w =
  power (sigma_0 p) (sigma_2 p) vel (fun w => m p (vel w)) N d al w z.
Proof.
  unfold power, force. rewrite friction_is, rate_is. unfold q, d. rewrite damping_level. reflexivity.
Qed.

Let beyond w z : @any U w -> F_s p / sigma_0 p <= Rabs z -> al w z = 1 \/ (vel w * z <= 0 /\ al w z = 0).
Proof.
  intros _ Hz. apply (r_beyond _ _ _ _ _ law); [apply okq|]. rewrite gN.
  apply Rle_trans with (F_s p / sigma_0 p); [|exact Hz]. pose proof (N_range w). destruct cs as (? & _).
  apply Rmult_le_compat_r; [apply Rlt_le, Rinv_0_lt_compat|]; lra.
Qed.

Lemma input_bounded u z t1 t2 : motion (fun w z => dz (q w) (vel w) z) u z t1 t2 ->
  Rabs (z t1) <= F_s p / sigma_0 p -> forall t, t1 <= t <= t2 -> Rabs (z t) <= F_s p / sigma_0 p.
Proof.
  intros M. destruct cs as (C0 & C1 & C2 & C3 & C4).
  apply (bounded (sigma_0 p) (m0 p) vel (fun w => m p (vel w)) N al any (F_c p) (F_s p) C0 C3) with (u := u).
  - intros w _. apply (r_majorant _ _ _ _ _ law); exact Hp.
  - intros w _. apply N_range.
  - exact beyond.
  - apply (motion_ext (fun w z => dz (q w) (vel w) z) _ any); [|intros; exact I|exact M].
    intros w x _. apply rate_is.
  - intros t _. exact I.
Qed.

Lemma input_force_continuous : continuous_2 (fun w z => friction (q w) (vel w) z).
Proof.
  apply (c_ext (fun w z => sigma_0 p * z + d w * dz (q w) (vel w) z + sigma_2 p * vel w)).
  - intros w z. rewrite friction_is. unfold q, d. rewrite damping_level. reflexivity.
  - assert (c1 : continuous_2 (fun w z => dz (q w) (vel w) z)).
    { apply (r_continuous _ _ _ _ _ law); auto. apply Hlevel. }
    assert (c2 : continuous_2 (fun w (_ : R) => vel w)) by (apply c_fst, Hvel).
    assert (c3 : continuous_2 (fun w (_ : R) => d w)).
    { apply c_fst. intros w. apply (continuous_comp vel (damping p)); auto. }
    cont.
Qed.

Let power_continuous : continuous_2 (power (sigma_0 p) (sigma_2 p) vel (fun w => m p (vel w)) N d al).
Proof.
  apply (c_ext (fun w z => friction (q w) (vel w) z * vel w)); [intros; apply power_is|].
  apply (c_mult (fun w z => friction (q w) (vel w) z) (fun w _ => vel w)); [exact input_force_continuous|].
  apply c_fst, Hvel.
Qed.

Lemma input_stores : sigma_1 p * m0 p <= F_s p -> sigma_1 p * (F_s p - F_c p) <= sigma_2 p * F_c p ->
  storage (fun w z => dz (q w) (vel w) z) any (fun w z => friction (q w) (vel w) z * vel w)
    (fun z => Rabs z <= F_s p / sigma_0 p) (fun z => sigma_0 p * (z * z) / 2).
Proof.
  intros Hm HL. destruct cs as (C0 & C1 & C2 & C3 & C4).
  apply (storage_ext (rate (sigma_0 p) vel (fun w => m p (vel w)) N al) _
    (power (sigma_0 p) (sigma_2 p) vel (fun w => m p (vel w)) N d al) _ any).
  - intros w x _. apply rate_is.
  - intros w x _. symmetry. apply power_is.
  - apply (stores (sigma_0 p) (sigma_2 p) (m0 p) vel _ N d al any (F_c p) (F_s p) (sigma_1 p)); auto.
    + intros w _. apply damping_range. exact Hp.
    + intros w _. apply (r_majorant _ _ _ _ _ law); exact Hp.
    + intros w z _. apply (r_share _ _ _ _ _ law). apply okq.
Qed.

Lemma input_stores_damped : (forall v, damping p v * (Rabs v + m0 p) <= 4 * F_c p) ->
  storage (fun w z => dz (q w) (vel w) z) any (fun w z => friction (q w) (vel w) z * vel w)
    any (fun z => sigma_0 p * (z * z) / 2).
Proof.
  intros H4. destruct cs as (C0 & C1 & C2 & C3 & C4).
  apply (storage_ext (rate (sigma_0 p) vel (fun w => m p (vel w)) N al) _
    (power (sigma_0 p) (sigma_2 p) vel (fun w => m p (vel w)) N d al) _ any).
  - intros w x _. apply rate_is.
  - intros w x _. symmetry. apply power_is.
  - apply (stores_damped (sigma_0 p) (sigma_2 p) (m0 p) vel _ N d al any (F_c p) (F_s p) (sigma_1 p)); auto.
    + intros w _. apply damping_range. exact Hp.
    + intros w _. apply (r_majorant _ _ _ _ _ law); exact Hp.
    + intros w z _. apply (r_share _ _ _ _ _ law). apply okq.
    + intros w _. pose proof (H4 (vel w)). pose proof (N_range w). pose proof (damping_range p (vel w) Hp).
      pose proof (r_majorant _ _ _ _ _ law p (vel w) Hp). unfold d.
      apply Rle_trans with (damping p (vel w) * (Rabs (vel w) + m0 p)); [|lra].
      apply Rmult_le_compat_l; lra.
Qed.
End Input.

(* --- a level that is constant ------------------------------------------------------------------------------------- *)
Section Constant.
Variable p : constants.
Hypothesis Hp : ok p.

Let same : forall w : R_UniformSpace, F_c p <= F_c p <= F_s p /\ F_s p <= F_s p.
Proof. intros _. pose proof (r_constants _ _ _ _ _ law p Hp). lra. Qed.
Let cid : forall w, continuous (T := R_UniformSpace) (U := R_UniformSpace) (fun v : R => v) w.
Proof. intros w. apply continuous_id. Qed.
Let cc c : forall w, continuous (T := R_UniformSpace) (U := R_UniformSpace) (fun _ : R => c) w.
Proof. intros w. apply continuous_const. Qed.

Theorem law_bounded v z t1 t2 : motion (U := R_UniformSpace) (dz p) v z t1 t2 ->
  Rabs (z t1) <= F_s p / sigma_0 p -> forall t, t1 <= t <= t2 -> Rabs (z t) <= F_s p / sigma_0 p.
Proof.
  pose proof (input_bounded (U := R_UniformSpace) p (fun v => v) (fun _ => F_c p) (fun _ => F_s p) Hp same v z t1 t2) as B.
  simpl in B. rewrite at_own_level in B. exact B.
Qed.

Lemma law_force_continuous : continuous_2 (U := R_UniformSpace) (friction p).
Proof.
  pose proof (input_force_continuous (U := R_UniformSpace) p (fun v => v) (fun _ => F_c p) (fun _ => F_s p) Hp
    cid (cc _) (cc _) same) as B.
  simpl in B. rewrite at_own_level in B. exact B.
Qed.

Theorem law_stores : sigma_1 p * m0 p <= F_s p -> sigma_1 p * (F_s p - F_c p) <= sigma_2 p * F_c p ->
  storage (U := R_UniformSpace) (dz p) any (power_of (friction p)) (fun z => Rabs z <= F_s p / sigma_0 p)
    (fun z => sigma_0 p * (z * z) / 2).
Proof.
  intros Hm HL. pose proof (input_stores (U := R_UniformSpace) p (fun v => v) (fun _ => F_c p) (fun _ => F_s p) Hp
    cid (cc _) (cc _) same Hm HL) as B.
  simpl in B. rewrite at_own_level in B. exact B.
Qed.

Theorem law_stores_damped : (forall v, damping p v * (Rabs v + m0 p) <= 4 * F_c p) ->
  storage (U := R_UniformSpace) (dz p) any (power_of (friction p)) any (fun z => sigma_0 p * (z * z) / 2).
Proof.
  intros H4. pose proof (input_stores_damped (U := R_UniformSpace) p (fun v => v) (fun _ => F_c p) (fun _ => F_s p) Hp
    cid (cc _) (cc _) same H4) as B.
  simpl in B. rewrite at_own_level in B. exact B.
Qed.
End Constant.
End Theorems.

(* --- a level that varies: the input is (v, (F_c, F_s)); p holds the smallest F_c and the largest F_s ------------------ *)
Definition Levels : UniformSpace := prod_UniformSpace R_UniformSpace (prod_UniformSpace R_UniformSpace R_UniformSpace).
Definition velocity (w : Levels) : R := fst w.
Definition level_c (w : Levels) : R := fst (snd w).
Definition level_s (w : Levels) : R := snd (snd w).
Definition within_levels (p : constants) (w : Levels) : Prop :=
  F_c p <= level_c w /\ level_c w <= level_s w /\ level_s w <= F_s p.
Definition varying (h : constants -> R -> R -> R) (p : constants) (w : Levels) (z : R) : R :=
  h (at_level p (level_c w) (level_s w)) (velocity w) z.
Definition varying_power (F : constants -> R -> R -> R) (p : constants) (w : Levels) (z : R) : R :=
  varying F p w z * velocity w.

Section Varying.
Variables (ok : constants -> Prop) (dz : constants -> R -> R -> R) (m : constants -> R -> R) (m0 : constants -> R).
Variables (share : constants -> R -> R -> R) (damping : constants -> R -> R) (friction : constants -> R -> R -> R).
Hypothesis law : relaxation ok dz m m0 share.
Hypothesis damping_range : forall p v, ok p -> 0 <= damping p v <= sigma_1 p.
Hypothesis damping_level : forall p Fc Fs v, damping (at_level p Fc Fs) v = damping p v.
Hypothesis damping_continuous : forall p v, ok p -> continuous (damping p) v.
Hypothesis friction_is : forall p v z, friction p v z = sigma_0 p * z + damping p v * dz p v z + sigma_2 p * v.
Variable p : constants.
Hypothesis Hp : ok p.

(* Inputs outside the range are led back to it, so that the equations mean something everywhere. *)
Let c_ (w : Levels) := Rmax (F_c p) (Rmin (F_s p) (level_c w)).
Let s_ (w : Levels) := Rmax (c_ w) (Rmin (F_s p) (level_s w)).

Let range w : F_c p <= c_ w <= s_ w /\ s_ w <= F_s p.
Proof.
  pose proof (r_constants _ _ _ _ _ law p Hp). unfold s_, c_.
  repeat (unfold Rmax, Rmin; match goal with |- context [Rle_dec ?a ?b] => destruct (Rle_dec a b) end); lra.
Qed.
Let kept w : within_levels p w -> c_ w = level_c w /\ s_ w = level_s w.
Proof.
  intros (A & B & C). unfold s_, c_.
  rewrite (Rmin_right (F_s p) (level_c w)), (Rmin_right (F_s p) (level_s w)) by lra.
  rewrite (Rmax_right (F_c p)) by lra. rewrite Rmax_right by lra. auto.
Qed.
Let cv (w : Levels) : continuous velocity w. Proof. apply continuous_fst. Qed.
Let continuous_level_c (w : Levels) : continuous level_c w.
Proof. apply (continuous_comp (fun w : Levels => snd w) fst); [apply continuous_snd|apply continuous_fst]. Qed.
Let continuous_level_s (w : Levels) : continuous level_s w.
Proof. apply (continuous_comp (fun w : Levels => snd w) snd); [apply continuous_snd|apply continuous_snd]. Qed.

Let continuous_max (h k : Levels -> R) w : continuous h w -> continuous k w -> continuous (fun w => Rmax (h w) (k w)) w.
Proof.
  intros H K. apply (continuous_ext (fun w => (h w + k w + Rabs (h w - k w)) * / 2)); [intros; symmetry; apply Rmax_is|].
  apply (continuous_mult (fun w => h w + k w + Rabs (h w - k w)) (fun _ => / 2)); [|apply continuous_const].
  apply (continuous_plus (fun w => h w + k w)); [apply (continuous_plus h k); assumption|].
  apply (continuous_comp (fun w => h w - k w) Rabs); [apply (continuous_minus h k); assumption|apply continuous_Rabs].
Qed.
Let continuous_min (h k : Levels -> R) w : continuous h w -> continuous k w -> continuous (fun w => Rmin (h w) (k w)) w.
Proof.
  intros H K. apply (continuous_ext (fun w => (h w + k w - Rabs (h w - k w)) * / 2)); [intros; symmetry; apply Rmin_is|].
  apply (continuous_mult (fun w => h w + k w - Rabs (h w - k w)) (fun _ => / 2)); [|apply continuous_const].
  apply (continuous_minus (fun w => h w + k w)); [apply (continuous_plus h k); assumption|].
  apply (continuous_comp (fun w => h w - k w) Rabs); [apply (continuous_minus h k); assumption|apply continuous_Rabs].
Qed.
Let cc w : continuous c_ w.
Proof.
  apply continuous_max; [apply continuous_const|]. apply continuous_min; [apply continuous_const|apply continuous_level_c].
Qed.
Let cs w : continuous s_ w.
Proof. apply continuous_max; [apply cc|]. apply continuous_min; [apply continuous_const|apply continuous_level_s]. Qed.

Let same h w z : within_levels p w -> varying h p w z = h (at_level p (c_ w) (s_ w)) (velocity w) z.
Proof. intros H. destruct (kept w H) as [-> ->]. reflexivity. Qed.

Theorem varying_bounded u z t1 t2 : motion (varying dz p) u z t1 t2 -> (forall t, t1 <= t <= t2 -> within_levels p (u t)) ->
  Rabs (z t1) <= F_s p / sigma_0 p -> forall t, t1 <= t <= t2 -> Rabs (z t) <= F_s p / sigma_0 p.
Proof.
  intros M Hu. apply (input_bounded ok dz m m0 share law p velocity c_ s_ Hp range u z t1 t2).
  apply (motion_ext (varying dz p) _ (within_levels p)); auto.
Qed.

Lemma varying_force_inside u z a b : piece (varying dz p) u z a b -> (forall t, a < t < b -> within_levels p (u t)) ->
  exists F', (forall t, continuous (T := R_UniformSpace) (U := R_UniformSpace) F' t) /\
    forall t, a < t < b -> varying friction p (u t) (z t) = F' t.
Proof.
  intros [_ (u' & z' & Hu & Hz & E & Hd)] W.
  exists (fun t => friction (at_level p (c_ (u' t)) (s_ (u' t))) (velocity (u' t)) (z' t)). split.
  - intros t. pose proof (input_force_continuous ok dz m m0 share damping friction law damping_level damping_continuous
      friction_is p velocity c_ s_ Hp cv cc cs range) as C.
    apply (continuous_comp_2 u' z' (fun w x => friction (at_level p (c_ w) (s_ w)) (velocity w) x)); auto.
  - intros t Ht. destruct (Hd t Ht) as [<- _]. rewrite (E t) by lra. apply same. apply W. exact Ht.
Qed.

Theorem varying_stores : sigma_1 p * m0 p <= F_s p -> sigma_1 p * (F_s p - F_c p) <= sigma_2 p * F_c p ->
  storage (varying dz p) (within_levels p) (varying_power friction p) (fun z => Rabs z <= F_s p / sigma_0 p)
    (fun z => sigma_0 p * (z * z) / 2).
Proof.
  intros Hm HL.
  apply (storage_ext (fun w z => dz (at_level p (c_ w) (s_ w)) (velocity w) z) _
    (fun w z => friction (at_level p (c_ w) (s_ w)) (velocity w) z * velocity w)).
  - intros w x Hw. apply same; exact Hw.
  - intros w x Hw. unfold varying_power. rewrite same by exact Hw. reflexivity.
  - apply (storage_less _ _ any); [intros; exact I|].
    apply (input_stores ok dz m m0 share damping friction); auto.
Qed.

Theorem varying_stores_damped : (forall v, damping p v * (Rabs v + m0 p) <= 4 * F_c p) ->
  storage (varying dz p) (within_levels p) (varying_power friction p) any (fun z => sigma_0 p * (z * z) / 2).
Proof.
  intros H4.
  apply (storage_ext (fun w z => dz (at_level p (c_ w) (s_ w)) (velocity w) z) _
    (fun w z => friction (at_level p (c_ w) (s_ w)) (velocity w) z * velocity w)).
  - intros w x Hw. apply same; exact Hw.
  - intros w x Hw. unfold varying_power. rewrite same by exact Hw. reflexivity.
  - apply (storage_less _ _ any); [intros; exact I|].
    apply (input_stores_damped ok dz m m0 share damping friction); auto.
Qed.
End Varying.
